//! A name from another slicer -> ours, or that it is not supported yet.
//!
//! Names are those of PrusaSlicer and Slic3r, of OrcaSlicer and Bambu Studio, and of
//! CuraEngine, as keys of a profile and as flags. Whoever comes from there writes them
//! by habit; a guess by spelling would answer with something else that looks alike.
//!
//! - A *meaning* is our key, whose unit may differ, or that there is no such thing here yet.
//! - Each name has one meaning. A name that several of them use for different things has the most
//!   usual one.
//! - What people say without thinking of a slicer, such as `flow`, stands in a table of its own.
//! - To take up a feature, move its names from the second table to a row of the first.

/// What a name of another slicer means here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foreign {
    /// Our key for it. Units may differ.
    Key(&'static str),
    /// What it would do, as a noun: there is no such thing here yet.
    NotSupported(&'static str),
}

/// What `name`, a key or a flag without its dashes, means here, if another slicer has it.
#[must_use]
pub fn meaning(name: &str) -> Option<Foreign> {
    let name = name.to_lowercase().replace('-', "_");
    let last = name.rsplit('.').next().unwrap_or_default();
    let key = |name: &str| {
        let has = |theirs: &Names| theirs.iter().any(|names| names.contains(&name));
        let others = KEYS.iter().find(|(_, theirs)| has(theirs)).map(|(ours, _)| *ours);
        let usual = || USUAL.iter().find(|(_, names)| names.contains(&name)).map(|(ours, _)| *ours);
        others.or_else(usual).map(Foreign::Key)
    };
    let missing = |name: &str| {
        let row = NOT_SUPPORTED.iter().find(|(_, theirs)| theirs.contains(&name));
        row.map(|(what, _)| Foreign::NotSupported(what))
    };
    // Whoever looks for the right table may have put it into one of ours.
    [name.as_str(), last].into_iter().find_map(|name| key(name).or_else(|| missing(name)))
}

/// What other slicers call a key: PrusaSlicer and Slic3r; OrcaSlicer and Bambu Studio, where they have
/// another name; Cura.
pub type Names = [&'static [&'static str]; 3];

/// Our keys, each with its names in other slicers.
pub fn names() -> impl Iterator<Item = (&'static str, Names)> {
    KEYS.iter().copied()
}

/// Our key, and what others call it; a name that several have stands with the first.
#[rustfmt::skip]
const KEYS: &[(&str, Names)] = &[
    ("first_layer_height", [&[], &["initial_layer_print_height"], &["initial_layer_height", "layer_height_0"]]),
    ("line_width", [&["extrusion_width", "perimeter_extrusion_width", "external_perimeter_extrusion_width", "infill_extrusion_width"], &["outer_wall_line_width", "inner_wall_line_width", "sparse_infill_line_width"], &["wall_line_width", "infill_line_width"]]),
    ("tolerance", [&["resolution", "gcode_resolution"], &[], &["meshfix_maximum_resolution", "meshfix_maximum_deviation"]]),
    ("walls", [&["perimeters"], &["wall_loops"], &["wall_line_count", "wall_count", "wall_thickness", "shells"]]),
    ("outer_wall_inset", [&[], &[], &["wall_0_inset"]]),
    ("min_feature", [&["min_feature_size", "perimeter_generator", "wall_distribution_count", "thin_walls"], &["wall_generator", "detect_thin_wall"], &["fill_outline_gaps"]]),
    ("min_bead_width", [&[], &[], &["min_even_wall_line_width", "min_odd_wall_line_width", "min_wall_line_width"]]),
    ("wall_order", [&["external_perimeters_first"], &["wall_sequence"], &["wall_infill_order", "inset_direction", "outer_inset_first"]]),
    ("seam", [&["seam_position"], &[], &["z_seam_type", "z_seam_position", "z_seam_corner"]]),
    ("seam_inner", [&["staggered_inner_seams"], &["seam_stagger"], &[]]),
    ("seam_gap", [&["seam_gap_distance"], &[], &["coasting_volume", "coasting_enable"]]),
    ("seam_wipe", [&[], &["wipe_on_loops"], &["wall_0_wipe_dist"]]),
    ("skin_layers", [&["solid_layers"], &[], &[]]),
    ("top_thickness", [&["top_solid_min_thickness"], &["top_shell_thickness"], &["top_bottom_thickness"]]),
    ("bottom_thickness", [&["bottom_solid_min_thickness"], &["bottom_shell_thickness"], &[]]),
    ("top_layers", [&["top_solid_layers"], &["top_shell_layers"], &[]]),
    ("bottom_layers", [&["bottom_solid_layers"], &["bottom_shell_layers"], &["initial_bottom_layers"]]),
    ("skin_reach", [&[], &[], &["expand_skins_expand_distance", "top_skin_expand_distance", "bottom_skin_expand_distance"]]),
    ("infill", [&["fill_density"], &["sparse_infill_density"], &["infill_sparse_density", "infill_density"]]),
    ("pattern", [&["fill_pattern"], &["sparse_infill_pattern"], &["infill_pattern"]]),
    ("angle", [&["fill_angle"], &["infill_direction", "solid_infill_direction"], &["infill_angles"]]),
    ("infill_start", [&[], &[], &["infill_offset_x", "infill_offset_y"]]),
    ("infill_overlap", [&[], &["infill_wall_overlap"], &["infill_overlap_mm", "skin_overlap"]]),
    ("arcs", [&["arc_fitting"], &["enable_arc_fitting"], &["arcwelder_enable"]]),
    ("arc_tolerance", [&["arc_fitting_tolerance"], &[], &["arcwelder_resolution"]]),
    ("dual.mode", [&["infill_every_layers"], &["infill_combination"], &[]]),
    ("dual.ratio", [&["automatic_infill_combination"], &[], &["infill_sparse_thickness"]]),
    ("dual.max_bead_height", [&["automatic_infill_combination_max_layer_height"], &["infill_combination_max_layer_height"], &[]]),
    ("dual.parts", [&[], &[], &["support_infill_sparse_thickness"]]),
    ("support.enabled", [&["support_material", "support_material_auto"], &["enable_support"], &["support_enable", "generate_support", "supports"]]),
    ("support.threshold_angle", [&["support_material_threshold"], &["support_threshold_angle"], &["support_angle"]]),
    ("support.spacing", [&["support_material_spacing"], &["support_base_pattern_spacing"], &["support_line_distance"]]),
    ("support.expansion", [&[], &["support_expansion"], &["support_offset"]]),
    ("support.xy_distance", [&["support_material_xy_spacing"], &["support_object_xy_distance"], &["support_xy_distance"]]),
    ("support.z_distance", [&["support_material_contact_distance"], &["support_top_z_distance", "support_bottom_z_distance"], &["support_z_distance", "support_top_distance"]]),
    ("support.stands_on", [&["support_material_buildplate_only"], &["support_on_build_plate_only"], &["support_type"]]),
    ("skirt.loops", [&["skirts"], &["skirt_loops"], &["skirt_line_count"]]),
    ("skirt.distance", [&["skirt_distance"], &[], &["skirt_gap"]]),
    ("skirt.min_length", [&["min_skirt_length"], &[], &["skirt_brim_minimal_length"]]),
    ("skirt.layers", [&["skirt_height"], &[], &[]]),
    ("brim.where", [&["brim_type"], &[], &["adhesion_type", "brim_location", "brim_outside_only"]]),
    ("brim.width", [&["brim_width"], &[], &["brim_line_count"]]),
    ("brim.gap", [&["brim_separation"], &["brim_object_gap"], &["brim_gap"]]),
    ("first_layer_width", [&["first_layer_extrusion_width"], &["initial_layer_line_width"], &["initial_layer_line_width_factor"]]),
    ("raft.enabled", [&["raft", "raft_layers"], &[], &[]]),
    ("raft.margin", [&["raft_expansion", "raft_first_layer_expansion"], &[], &["raft_margin", "raft_base_margin"]]),
    ("raft.gap", [&["raft_contact_distance"], &[], &["raft_airgap"]]),
    ("raft.base_height", [&[], &[], &["raft_base_thickness"]]),
    ("raft.base_width", [&[], &[], &["raft_base_line_width"]]),
    ("raft.base_spacing", [&["raft_first_layer_density"], &[], &["raft_base_line_spacing"]]),
    ("raft.interface_layers", [&[], &[], &["raft_interface_layers", "raft_surface_layers"]]),
    ("raft.interface_height", [&[], &[], &["raft_interface_thickness", "raft_surface_thickness"]]),
    ("raft.interface_spacing", [&[], &[], &["raft_interface_line_spacing", "raft_surface_line_spacing"]]),
    ("xy_compensation", [&["xy_size_compensation"], &["xy_contour_compensation"], &["xy_offset"]]),
    ("hole_compensation", [&[], &["xy_hole_compensation"], &["hole_xy_offset"]]),
    ("elephant_foot", [&["elefant_foot_compensation"], &[], &["xy_offset_layer_0"]]),
    ("extrusion.first_layer", [&[], &["first_layer_flow_ratio", "initial_layer_flow_ratio"], &["material_flow_layer_0"]]),
    ("filament.first_layer_temperature", [&["first_layer_temperature"], &["nozzle_temperature_initial_layer"], &["material_print_temperature_layer_0"]]),
    ("filament.first_layer_bed_temperature", [&["first_layer_bed_temperature"], &["hot_plate_temp_initial_layer", "bed_temperature_initial_layer"], &["material_bed_temperature_layer_0"]]),
    ("speed.wall", [&["perimeter_speed"], &[], &["speed_wall", "print_speed", "speed_print"]]),
    ("speed.outer_wall", [&["external_perimeter_speed"], &["outer_wall_speed"], &["speed_wall_0"]]),
    ("speed.inner_wall", [&[], &["inner_wall_speed"], &["speed_wall_x"]]),
    ("speed.small_loop", [&["small_perimeter_speed"], &[], &["small_feature_speed_factor"]]),
    ("speed.small_loop_length", [&[], &["small_perimeter_threshold"], &["small_feature_max_length", "small_hole_max_size"]]),
    ("speed.skin", [&["solid_infill_speed"], &["internal_solid_infill_speed"], &["speed_topbottom"]]),
    ("speed.ironing", [&["ironing_speed"], &[], &["speed_ironing"]]),
    ("speed.top_skin", [&["top_solid_infill_speed"], &["top_surface_speed"], &["speed_roofing"]]),
    ("speed.gap", [&["gap_fill_speed"], &["gap_infill_speed"], &[]]),
    ("top_one_wall", [&["top_one_perimeter_type"], &["only_one_wall_top"], &["roofing_wall_line_count"]]),
    ("top_monotonic", [&["monotonic"], &[], &["skin_monotonic", "roofing_monotonic"]]),
    ("speed.infill", [&["infill_speed"], &["sparse_infill_speed"], &["speed_infill"]]),
    ("speed.support", [&["support_material_speed"], &["support_speed"], &["speed_support"]]),
    ("speed.raft_base", [&[], &[], &["raft_base_speed"]]),
    ("speed.raft_interface", [&[], &[], &["raft_speed", "raft_interface_speed", "raft_surface_speed"]]),
    ("speed.travel", [&["travel_speed"], &[], &["speed_travel"]]),
    ("speed.z", [&["travel_speed_z"], &[], &["speed_z_hop"]]),
    ("speed.first_layer", [&["first_layer_speed"], &[], &["initial_layer_speed", "speed_layer_0"]]),
    ("acceleration.wall", [&["perimeter_acceleration"], &[], &["acceleration_wall"]]),
    ("acceleration.outer_wall", [&["external_perimeter_acceleration"], &["outer_wall_acceleration"], &["acceleration_wall_0"]]),
    ("acceleration.inner_wall", [&[], &["inner_wall_acceleration"], &["acceleration_wall_x"]]),
    ("acceleration.skin", [&["solid_infill_acceleration"], &["internal_solid_infill_acceleration"], &["acceleration_topbottom"]]),
    ("acceleration.top_skin", [&["top_solid_infill_acceleration"], &["top_surface_acceleration"], &["acceleration_roofing"]]),
    ("acceleration.bridge", [&["bridge_acceleration"], &[], &[]]),
    ("acceleration.infill", [&["infill_acceleration"], &["sparse_infill_acceleration"], &["acceleration_infill"]]),
    ("acceleration.support", [&[], &[], &["acceleration_support"]]),
    ("acceleration.first_layer", [&["first_layer_acceleration"], &["initial_layer_acceleration"], &["acceleration_layer_0", "acceleration_print_layer_0"]]),
    ("acceleration.travel", [&["travel_acceleration"], &[], &["acceleration_travel"]]),
    ("jerk.wall", [&[], &[], &["jerk_wall"]]),
    ("jerk.outer_wall", [&[], &["outer_wall_jerk"], &["jerk_wall_0"]]),
    ("jerk.inner_wall", [&[], &["inner_wall_jerk"], &["jerk_wall_x"]]),
    ("jerk.skin", [&[], &[], &["jerk_topbottom"]]),
    ("jerk.top_skin", [&[], &["top_surface_jerk"], &["jerk_roofing"]]),
    ("jerk.infill", [&[], &["infill_jerk"], &["jerk_infill"]]),
    ("jerk.support", [&[], &[], &["jerk_support"]]),
    ("jerk.first_layer", [&[], &["initial_layer_jerk"], &["jerk_layer_0"]]),
    ("jerk.travel", [&[], &["travel_jerk"], &["jerk_travel"]]),
    ("extrusion.multiplier", [&["extrusion_multiplier"], &["filament_flow_ratio", "print_flow_ratio", "flow_ratio"], &["material_flow"]]),
    ("retraction.length", [&["retract_length"], &["retraction_length"], &["retraction_amount", "retraction_distance"]]),
    ("retraction.speed", [&["retract_speed", "deretract_speed"], &["deretraction_speed"], &["retraction_speed", "retraction_retract_speed", "retraction_prime_speed"]]),
    ("retraction.when", [&["only_retract_when_crossing_perimeters"], &["reduce_infill_retraction"], &["retraction_enable"]]),
    ("retraction.min_travel", [&["retract_before_travel"], &["retraction_minimum_travel"], &["retraction_min_travel"]]),
    ("retraction.max_travel", [&[], &[], &["retraction_combing_max_distance"]]),
    ("retraction.wipe", [&["wipe"], &["wipe_distance"], &["wipe_length", "infill_wipe_dist", "wipe_retraction_enable"]]),
    ("travel.avoid_crossing", [&["avoid_crossing_perimeters"], &["reduce_crossing_wall"], &["retraction_combing", "travel_avoid_other_parts", "combing"]]),
    ("travel.max_detour", [&["avoid_crossing_perimeters_max_detour"], &["max_travel_detour_distance"], &[]]),
    ("retraction.z_hop", [&["retract_lift"], &["z_hop"], &["retraction_hop", "retraction_hop_enabled", "z_lift"]]),
    ("filament.name", [&["filament_type", "filament_settings_id"], &[], &["material_name"]]),
    ("filament.diameter", [&["filament_diameter"], &[], &["material_diameter"]]),
    ("filament.density", [&["filament_density"], &[], &["material_density"]]),
    ("filament.temperature", [&["temperature"], &["nozzle_temperature"], &["material_print_temperature"]]),
    ("filament.bed_temperature", [&["bed_temperature"], &["hot_plate_temp"], &["material_bed_temperature"]]),
    ("filament.fan", [&["max_fan_speed", "fan_always_on", "cooling"], &["fan_max_speed"], &["fan_speed", "cool_fan_speed", "cool_fan_speed_max", "cool_fan_enabled"]]),
    ("ironing.where", [&["ironing", "ironing_type"], &[], &["ironing_enabled", "ironing_only_highest_layer"]]),
    ("ironing.flow", [&["ironing_flowrate"], &[], &["ironing_flow"]]),
    ("ironing.spacing", [&["ironing_spacing"], &[], &["ironing_line_spacing"]]),
    ("ironing.inset", [&[], &[], &["ironing_inset"]]),
    ("nonplanar.enabled", [&["nonplanar_layers"], &["zaa_enabled"], &[]]),
    ("nonplanar.min_area", [&["nonplanar_minimal_area"], &[], &[]]),
    ("nonplanar.min_height", [&[], &["zaa_min_z"], &[]]),
    ("head.flat", [&[], &[], &["machine_nozzle_tip_outer_diameter"]]),
    ("head.cone", [&["nonplanar_layers_angle", "nonplanar_layers_collision_angle"], &[], &["machine_nozzle_expansion_angle"]]),
    ("head.cone_length", [&["nonplanar_layers_height"], &["nozzle_height"], &["machine_nozzle_head_distance"]]),
    ("head.discs", [&["extruder_clearance_radius", "extruder_clearance_height"], &["extruder_clearance_height_to_rod", "extruder_clearance_height_to_lid"], &[]]),
    ("head.boxes", [&[], &["head_wrap_detect_zone"], &["machine_head_with_fans_polygon", "machine_head_polygon", "gantry_height"]]),
    ("filament.fan_from_layer", [&["disable_fan_first_layers"], &["close_fan_the_first_x_layers"], &[]]),
    ("filament.shrinkage", [&["filament_shrinkage_compensation_xy"], &["filament_shrink"], &["material_shrinkage_percentage", "material_shrinkage_percentage_xy"]]),
    ("filament.shrinkage_z", [&["filament_shrinkage_compensation_z"], &[], &["material_shrinkage_percentage_z"]]),
    ("filament.pressure_advance", [&["pressure_advance", "linear_advance"], &["enable_pressure_advance"], &["material_pressure_advance_factor"]]),
    ("filament.cost", [&["filament_cost"], &[], &["material_cost"]]),
    ("cooling.min_layer_time", [&["slowdown_below_layer_time"], &["slow_down_layer_time", "slow_down_for_layer_cooling"], &["cool_min_layer_time", "minimum_layer_time"]]),
    ("cooling.min_speed", [&["min_print_speed"], &["slow_down_min_speed"], &["cool_min_speed"]]),
    ("cooling.wait", [&[], &[], &["cool_lift_head"]]),
    ("cooling.min_fan", [&["min_fan_speed"], &["fan_min_speed"], &["cool_fan_speed_min"]]),
    ("cooling.min_fan_time", [&["fan_below_layer_time"], &["fan_cooling_layer_time"], &["cool_min_layer_time_fan_speed_max"]]),
    ("cooling.fan_full_from_layer", [&["full_fan_speed_layer"], &[], &["cool_fan_full_layer", "cool_fan_full_at_height"]]),
    ("cooling.bridge_fan", [&["bridge_fan_speed"], &[], &[]]),
    ("cooling.overhang_fan", [&[], &["overhang_fan_speed"], &[]]),
    ("cooling.interface_fan", [&[], &["support_material_interface_fan_speed"], &[]]),
    ("machine.name", [&["printer_model"], &[], &["printer_name", "machine_name"]]),
    ("machine.dialect", [&["gcode_flavor"], &[], &["machine_gcode_flavor"]]),
    ("machine.bed_width", [&["bed_shape"], &["printable_area"], &["bed_size", "machine_width"]]),
    ("machine.bed_depth", [&[], &[], &["machine_depth"]]),
    ("machine.bed_height", [&["max_print_height"], &["printable_height"], &["machine_height"]]),
    ("machine.origin", [&[], &[], &["machine_center_is_zero"]]),
    ("machine.nozzle_diameter", [&["nozzle_diameter"], &[], &["machine_nozzle_size", "nozzle_size"]]),
    ("machine.acceleration", [&["default_acceleration", "machine_max_acceleration_extruding"], &[], &["acceleration_print", "machine_acceleration"]]),
    ("machine.relative_e", [&["use_relative_e_distances"], &[], &["relative_extrusion"]]),
    ("machine.arc_segment", [&[], &[], &["arcwelder_mm_per_arc_segment"]]),
    ("filament.min_temperature", [&[], &["nozzle_temperature_range_low"], &[]]),
    ("filament.max_temperature", [&[], &["nozzle_temperature_range_high"], &[]]),
    ("machine.max_volumetric_speed", [&["max_volumetric_speed", "filament_max_volumetric_speed"], &[], &[]]),
    ("machine.thumbnails", [&["thumbnails"], &["thumbnail_size"], &[]]),
    ("machine.start_gcode", [&["start_gcode", "start_filament_gcode"], &[], &["machine_start_gcode"]]),
    ("machine.end_gcode", [&["end_gcode", "end_filament_gcode"], &[], &["machine_end_gcode"]]),
    ("limits.speed_x", [&["machine_max_feedrate_x"], &["machine_max_speed_x"], &[]]),
    ("limits.speed_y", [&["machine_max_feedrate_y"], &["machine_max_speed_y"], &[]]),
    ("limits.speed_z", [&["machine_max_feedrate_z"], &["machine_max_speed_z"], &[]]),
    ("limits.speed_e", [&["machine_max_feedrate_e"], &["machine_max_speed_e"], &[]]),
    ("limits.acceleration_x", [&["machine_max_acceleration_x"], &[], &[]]),
    ("limits.acceleration_y", [&["machine_max_acceleration_y"], &[], &[]]),
    ("limits.acceleration_z", [&["machine_max_acceleration_z"], &[], &[]]),
    ("limits.acceleration_e", [&["machine_max_acceleration_e"], &[], &[]]),
    ("limits.travel_acceleration", [&["machine_max_acceleration_travel"], &[], &[]]),
    ("limits.retract_acceleration", [&["machine_max_acceleration_retracting"], &[], &[]]),
    ("limits.jerk_x", [&["machine_max_jerk_x"], &["default_jerk"], &["jerk_print"]]),
    ("limits.jerk_y", [&["machine_max_jerk_y"], &[], &[]]),
    ("limits.jerk_z", [&["machine_max_jerk_z"], &[], &[]]),
    ("limits.jerk_e", [&["machine_max_jerk_e"], &[], &[]]),
    ("limits.junction_deviation", [&[], &["machine_max_junction_deviation"], &[]]),
    ("steps.x", [&[], &[], &["machine_steps_per_mm_x"]]),
    ("steps.y", [&[], &[], &["machine_steps_per_mm_y"]]),
    ("steps.z", [&[], &[], &["machine_steps_per_mm_z"]]),
    ("steps.e", [&[], &[], &["machine_steps_per_mm_e"]]),
    ("speed.bridge", [&["bridge_speed"], &[], &["bridge_skin_speed"]]),
    ("bridge.flow", [&["bridge_flow_ratio"], &["bridge_flow"], &["bridge_skin_material_flow"]]),
    ("bridge.enabled", [&[], &[], &["bridge_settings_enabled"]]),
    ("speed.overhang", [&["enable_dynamic_overhang_speeds", "overhangs"], &["enable_overhang_speed", "detect_overhang_wall"], &[]]),
    ("support.interface_layers", [&["support_material_interface_layers"], &["support_interface_top_layers"], &["support_interface_enable"]]),
    ("support.interface_spacing", [&["support_material_interface_spacing"], &["support_interface_spacing"], &["support_interface_density"]]),
];

/// Our keys, and what people call them, of whatever slicer.
#[rustfmt::skip]
const USUAL: &[(&str, &[&str])] = &[
    ("layer_height", &["layer", "layer_thickness"]),
    ("walls", &["perimeter", "shell"]),
    ("infill", &["infill.density", "infill_percentage", "fill"]),
    ("extrusion.multiplier", &["flow", "flow_rate", "flowrate", "flow_multiplier"]),
    ("filament.temperature", &["temp", "nozzle_temp", "hotend_temp", "hotend_temperature", "extruder_temperature", "print_temperature"]),
    ("filament.bed_temperature", &["bed", "bed_temp", "heatbed_temperature", "heated_bed_temperature"]),
    ("retraction.length", &["retraction.distance", "retraction.amount", "retract"]),
    ("machine.nozzle_diameter", &["nozzle"]),
    ("machine.bed_width", &["bed_x", "bed_size_x", "machine.width"]),
    ("machine.bed_depth", &["bed_y", "bed_size_y", "machine.depth"]),
    ("machine.bed_height", &["bed_z", "bed_size_z", "machine.height"]),
    ("machine.start_gcode", &["start.gcode", "gcode_start"]),
    ("machine.end_gcode", &["end.gcode", "gcode_end"]),
    ("machine.max_volumetric_speed", &["max_flow", "volumetric_speed", "max_volumetric_flow"]),
    ("speed.wall", &["speed.print", "speed.perimeter", "speed"]),
    ("filament.fan", &["fan", "fan_power"]),
];

/// What we cannot do, and what others call its settings.
#[rustfmt::skip]
const NOT_SUPPORTED: &[(&str, &[&str])] = &[
    ("brims at corners alone", &["brim_ears", "brim_ears_max_angle", "brim_smart_ordering"]),
    ("a spiral vase", &["spiral_vase", "spiral_mode", "magic_spiralize", "vase", "vase_mode", "spiralize"]),
    ("fuzzy skin", &["fuzzy_skin", "magic_fuzzy_skin_enabled"]),
    ("switching gap fill off", &["gap_fill_enabled", "fill_gaps", "filter_out_gap_fill", "gap_fill_target"]),
    ("a direction of bridges", &["bridge_angle"]),
    ("thick bridges", &["thick_bridges"]),
    ("a height of layers that varies", &["adaptive_layer_height", "adaptive_layer_height_enabled", "variable_layer_height", "adaptive_layers"]),
    ("adding walls where needed", &["extra_perimeters", "alternate_extra_perimeter", "alternate_extra_wall", "ensure_vertical_shell_thickness"]),
    ("a pattern for skins", &["top_fill_pattern", "bottom_fill_pattern", "top_surface_pattern", "bottom_surface_pattern", "top_bottom_pattern"]),
    ("solid infill between skins", &["solid_infill_every_layers", "solid_infill_below_area", "minimum_sparse_infill_area"]),
    ("a wipe tower", &["wipe_tower", "prime_tower_enable", "enable_prime_tower"]),
    ("printing with several tools", &["infill_extruder", "perimeter_extruder", "solid_infill_extruder", "support_material_extruder", "extruder_nr", "wall_extruder_nr"]),
    ("tree support", &["support_structure", "support_material_style", "support_tree_angle", "tree_support"]),
    ("printing one model after the other", &["complete_objects", "print_sequence"]),
    ("labelling of models", &["label_objects", "gcode_label_objects", "exclude_object"]),
    ("post-processing", &["post_process"]),
    ("a shift of z, for which firmwares have M851 and SET_GCODE_OFFSET,", &["z_offset", "layer_0_z_overlap"]),
    ("G-code between layers", &["before_layer_gcode", "layer_gcode", "after_layer_gcode", "before_layer_change_gcode", "layer_change_gcode", "time_lapse_gcode"]),
    ("G-code between models or tools", &["between_objects_gcode", "toolchange_gcode", "change_filament_gcode", "machine_extruder_start_code", "machine_extruder_end_code"]),
    ("a pause at a layer", &["pause_print_gcode", "color_change_gcode", "template_custom_gcode", "machine_pause_gcode", "pause_at_height"]),
    ("leaving out small collisions", &["nonplanar_layers_ignore_collision_size"]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::keys;

    #[test]
    fn names_are_there_once_and_lead_to_keys_of_ours() {
        let ours = KEYS.iter().flat_map(|(_, theirs)| theirs.iter().copied().flatten());
        let missing = NOT_SUPPORTED.iter().flat_map(|(_, theirs)| theirs.iter());
        let usual = USUAL.iter().flat_map(|(_, names)| names.iter());
        let mut all: Vec<&str> = ours.chain(missing).chain(usual).copied().collect();
        assert!(all.len() > 200, "{}", all.len());
        assert!(all.iter().all(|name| keys::find(name).is_none()));
        assert!(KEYS.iter().all(|(ours, _)| keys::find(ours).is_some()));
        assert!(USUAL.iter().all(|(ours, _)| keys::find(ours).is_some()));
        all.sort_unstable();
        let count = all.len();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn names_are_known_in_every_spelling_and_table() {
        for name in ["perimeters", "wall-loops", "Wall_Line_Count", "machine.perimeters"] {
            assert_eq!(meaning(name), Some(Foreign::Key("walls")), "{name}");
        }
        for name in ["flow", "filament.flow", "flow-rate"] {
            assert_eq!(meaning(name), Some(Foreign::Key("extrusion.multiplier")), "{name}");
        }
        assert_eq!(meaning("filament.bed"), Some(Foreign::Key("filament.bed_temperature")));
        assert!(matches!(meaning("machine.z_offset"), Some(Foreign::NotSupported(_))));
        assert!(matches!(meaning("before_layer_gcode"), Some(Foreign::NotSupported(_))));
        assert_eq!(meaning("brim-width"), Some(Foreign::Key("brim.width")));
        assert_eq!(meaning("wals"), None);
    }
}
