//! What a user would lose: twins, three-way agreement, goldens, oracles, the comparer itself, and the command line.

mod arrows;
mod attribution;
mod evaluation;
mod golden;
mod rays;
mod three_way;
