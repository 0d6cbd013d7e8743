//! A user's own corpus: model files as scenes.

use crate::listing::{Listed, listed};
use crate::terminal;
use clap::Args;
use std::collections::BTreeSet;
use suite::corpus::{Scene, Suite};

/// What is drawn instead of the corpus.
#[derive(Debug, Clone, Default, Args)]
pub struct OwnArgs {
    /// A model file, a directory of them or a pattern, each file a scene, instead of the corpus; may be given again
    #[arg(long, value_name = "PATH")]
    pub models: Vec<String>,
}

impl OwnArgs {
    /// The files as scenes, each once; where there are no such arguments, the scenes of a suite.
    ///
    /// They live as long as the program does, as those of the corpus do. What stands for no file is a scene, too: that it
    /// cannot be read is found where all models are.
    pub fn scenes(&self, suite: Suite) -> Vec<&'static Scene> {
        if self.models.is_empty() {
            return suite.scenes();
        }
        let mut names = BTreeSet::new();
        let files = listed(&self.models).into_iter().filter(|file| names.insert(file.name.clone()));
        let scene = |Listed { name, fault }: Listed| -> &'static Scene {
            if let Some(fault) = fault {
                terminal::note(format_args!("note: {name}: {fault}"));
            }
            Box::leak(Box::new(Scene::of_file(name.leak())))
        };
        files.map(scene).collect()
    }
}
