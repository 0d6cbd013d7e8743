//! What a user would lose: twins, three-way agreement, goldens, oracles, the comparer itself, and the command line.

mod approximated;
mod arrows;
mod attribution;
mod circles;
mod editing;
mod evaluation;
mod field;
mod folds;
mod foreign;
mod golden;
mod grids;
mod hidden;
mod judging;
mod kernels;
mod licences;
mod metadata;
mod rays;
mod samples;
mod seams;
mod snapping;
mod three_way;
mod toolchain;
mod trim_texture;
mod trims;
mod vacuity;
mod vertex_normals;
