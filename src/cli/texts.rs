//! Text -> `--help` and manual pages: what a command's reader needs beyond its flags.

/// What `check` may find.
pub(super) const FINDINGS: &str = "\
Findings, each with a stable code, a place and a measure:
  unknown-code         a command that the machine's firmware does not know
  missing-number       a word without the number that it needs, as in `M109 S`, or a placeholder that
                       no slicer has filled in
  not-homed            the print begins without G28 (or G92) of x, y and z, and without a macro that
                       may home; a warning for RepRapFirmware, which refuses such moves
  outside-volume       a line or travel beyond the machine's x, y or z
  through-print        a travel, of start and end block too, through what stands by the nozzle's
                       flat end, 2.5 times as wide as its hole, over 0.16 mm deep; a warning for an
                       end block that drags it over 3 mm of the print before it lifts it
  head-hits            part of [head] runs into plastic of the file, where lines go over slopes: a
                       travel by 0.02 mm; while printing the flat may press 1.5 layers deep within
                       its diameter; not judged where nobody tells the head (--head NAME)
  changes-the-machine  a command that changes what the rest relies on: G92 of an axis, steps,
                       offsets, flow, homing or motors off in the print, a tool that is not there,
                       heaters far from what the settings say, hotter after the print; limits of
                       speed, acceleration and jerk that are new in the print and beyond the
                       machine, or so low that it crawls (below 2 mm/s or 20 mm/s²); a warning for
                       others that the file's settings do not ask for (of other slicers' files for
                       M201 and M203 alone), pauses, waits (G4) of 20 s and more, changes of
                       filament, and what a start or end block need not do
  wrong-temperature    the nozzle or the bed is set to what the material does not take, or no
                       machine; the bed is switched off before the print
  cold-extrusion       filament is pushed before the nozzle is told to be hot and waited for
  left-on              the nozzle is still on when the file ends; a warning for the bed; not where a
                       macro comes last, nor of printers that end a job by themselves
  too-fast             faster than [limits] allow in x or y; in z in files of this program, or over
                       500 mm/s
  too-many-steps     * more steps a second than steps.rate_x, _y, _z or _e
  too-much-flow        5 % more than the hot end melts
  unpaired-retraction  a line with the filament pulled back, or more pushed out than was pulled
  odd-bead             under 0.55 or over 1.6 times the plastic that the role takes for its size
  falling-z            a line lower than what is printed already
  in-the-air           lines that hold on to one another, but stand on nothing
  floating             lines that begin a body, or an island of one, with nothing printed below; an
                       error where a body of more than a 2000th of the lines (8 to 500 mm), or the
                       whole print, never stands on the bed, else a warning, as when slicing
  unanchored         * over 3 mm of a line over nothing with a free end, along a void that it
                       should cross, or, of a wall, in a bow
  printed-twice        a line on the middle of another of its layer, over 10 mm or most of it;
                       lines on what the start block has primed
  uncovered-skin       1 mm² or more of a patch of non-planar skin, 0.3 mm wide, that its last skin
                       leaves open: 2.5 mm of a missing line; or that takes under 0.65 times its
                       plastic over 4 mm²
  double-skin          over 1.3 times the plastic that a patch has room for on what it lies on, in
                       squares of 1 mm
  overfilled         * over 1.3 times the plastic that walls and skins have room for, with infill lines
                       side by side on them, on one layer within 4 by 4 mm; an error where settings
                       ask for over 1.6 times, or where a whole patch takes over 1.3 times its plastic
  underfilled        * under 0.7 times that, or a fifth of the room between them left open; an error
                       where a whole patch takes under 0.7 times its plastic
  narrow-bead        * over 1 mm of a line narrower than 70 % of the nozzle
  slender-support    * support over 10 times as high as it is thick
  loose-infill       * the sparse infill touches under a quarter of the innermost walls
  wrong-sums           the file states another amount of filament or number of layers
  wrong-marks          a patch of non-planar skin has no end, or, in files of this program, its number
                       comes twice
  wrong-size           the walls do not lie along the part's outline, or the height differs
  open-outline         0.6 mm² or more of the outline is not printed, or nothing of an island of
                       0.3 mm² or more
  open-surface         0.6 mm² or more of a top or bottom surface is not printed
  outside-part         0.6 mm² or more is printed over 0.3 mm beside the part
  wrong-infill         another density of the infill than asked for, or none on some layers
  wrong-volume         walls and skins take under 80 or over 125 % of the plastic they have room
                       for

A kind marked * is a warning: a weak place of a print that can be made. Warnings are listed after
`warning:` and fail neither `check` nor --check; --strict lets them fail. What --allow names is
known: it is listed after `allowed:`, and does not count, be it an error or a warning.

What helps most often:
  unknown-code, missing-number, not-homed, cold-extrusion, left-on, changes-the-machine
                       mend machine.start_gcode or machine.end_gcode
  outside-volume       the right printer (-p), another place (--at) or a smaller --scale
  through-print        lift the nozzle before it goes aside: G1 Z{park_z} F600 in the end block
  head-hits            a head that is measured (--head, [head]); models further apart
  wrong-temperature    the right --material, or --temperature
  too-fast, too-many-steps, too-much-flow
                       lower speeds, or the printer's own limits in its profile
  in-the-air, floating, unanchored
                       --support, or turn the part (--rotate)
  narrow-bead          a smaller nozzle, or a larger min_feature
  slender-support      turn the part, or cut it
  loose-infill         a denser --infill
  wrong-size, open-outline, open-surface, outside-part, wrong-infill, wrong-volume
                       hold it against the model as it was sliced: --scale, --rotate, --copies, -p
  all others           slice anew; in a file of this program please report them

The part is cut anew at the middle of every layer, and compared with what is printed along rows
0.05 mm apart, wider apart in a print deeper than 300 mm. Places narrower than 1.2 lines need not
be printed. A file without comments does not tell what its lines are for: what cannot be judged is
listed.";

/// What is done about a broken mesh.
pub(super) const MENDING: &str = "\
A mesh is mended in this order:
  1. Triangles without area are dropped. Corners of open edges are welded within 0.02 mm, and
     within 0.1 mm where edges are still open, but by at most half of the shortest edge there.
  2. Of copies of a triangle one is kept, or none where they are an inner wall or a sheet.
  3. An edge with other corners on it is split at them.
  4. Triangles are wound like their neighbours.
  5. Gaps are closed: two rims along each other by a band, other holes by triangles over their
     rims. A rim that crosses itself, or whose filling would cross the surface, stays open.
  6. Fins and sheets are dropped. A shell that is inside out is turned; one that is wound inward
     within another is a cavity.
No corner is added, and only welding moves one. Bodies that overlap become one solid when they
are cut. Filled holes and dropped sheets are guesses and give a warning. What stays open is
closed layer by layer with lines of up to 2 mm; a model that needs longer ones is refused.
Coordinates in messages are the file's own.";

/// How dual injection works, in words of its flags.
pub(super) const DUAL: &str = "\
Dual injection (--dual) takes layers in groups of --dual-ratio. The first layer is alone.
  - Infill that all layers of a group have is printed on the uppermost, with the material of all.
  - What some layers in a row have is printed for these; what one layer has, on this layer.
  - The direction turns from group to group, so that thick lines cross.
A thick line is at most dual.max_bead_height tall, 100 % of the nozzle unless set: 0.2 mm layers
allow two, 0.1 mm layers four. `--dual-ratio auto` takes that many, but stops where the hot end
cannot melt more.
`--dual-mode interlaced` prints half of the lines thick on odd layers and half on even ones, so
that layers take alike.
--dual-parts says what is thick:
  infill       where the layers have it in the same place
  support      likewise
  inner-walls  where a loop runs along that of the layer below within a tenth of a line
  inner-skin   where at least one layer covers it, and it is wider than six lines
The report's dual.audit lists the material of each group against that of thin lines.";

/// How roughness is measured.
pub(super) const ROUGHNESS: &str = "\
Deviations are measured from the true surface of the model, at right angles to it, over cells of
0.05 mm (0.1 mm from 100 cm² of bed on), wherever it faces up by 45° or less:
  bead      the top of a line is level across its full width, as high as the nozzle was, straight
            from end to end, with round ends. A staircase of layers h high on a slope T so has Ra =
            h cos(T) / 4, and lines s apart across a slope have Ra = s sin(T) / 4. Plastic that
            flows is not in it
  top       of all beads over a cell the highest counts that is no more than 2 layers above the
            surface; without one down to 2 layers below it, nothing is near
  covered   share of the surface over which the top is within 0.8 layers of it, straight up or
            down. The steps of a staircase are half a layer off; where a line lacks it is a whole
            one
  mean      mean deviation; above 0 there is too much
  Ra Rq Rz  means over profiles along the steepest slope, a cell apart. Each place counts in that
            one of six directions, 30° apart, that is nearest to its own steepest slope. Rz is the
            height of a piece of a profile as long as the cut-off
  Sa Sq     means over the area
  plain     less the mean of the profile, or of the patch
  Gauss     less what the Gaussian filter lets through, of profiles by ISO 16610-21, over the area
            by ISO 16610-61. At borders and gaps the weights of what is there are made 1 in all
A patch is a piece of the surface joined over edges that bend by less than 30°. What slopes by less
than 0.5° is level: it has a row of its own, and is in no other. The model is placed as the flags
below say, then moved to where the lines are.

Exit codes: 0 measured, 2 wrong arguments or profile, 3 a file cannot be read, prints nothing, or
has no plastic near the model's tops.";

/// How commands end that read files and find nothing wrong with them.
pub(super) const CODES: &str = "\
Exit codes: 0 done, 2 wrong arguments or profile, 3 a file cannot be read or holds nothing to work
on, 4 an output cannot be written.";
