//! The conformance suite as a CI job meets it: complete, wrong, cut short, in parts; its documents and its page.

mod browser;
mod compilers;
mod corpus;
mod devtools;
mod documents;
mod faults;
mod merging;
mod own;
mod page;
mod player;
mod setting;
mod strict;
mod xsd;
