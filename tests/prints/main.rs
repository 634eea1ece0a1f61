//! Models -> G-code, read back: facts about whole prints, and files that are kept byte for byte.

#[path = "../common/mod.rs"]
mod common;

mod arcs;
mod bridges;
mod carried;
mod checked;
mod contour;
mod cooling;
mod fixtures;
mod floating;
mod golden;
mod gpx;
mod islands;
mod library;
mod metamorphic;
mod models;
mod motion;
mod narino;
mod nonplanar;
mod printers;
mod raft;
mod rings;
mod roofs;
mod rooms;
mod roughness;
mod routes;
mod seams;
mod segments;
mod skins;
mod sticking;
mod support;
mod tables;
mod thin;
mod times;
mod tops;
mod whole;
