//! `bless`: the goldens of the CPU's renderers.

use anyhow::{Context, Result};
use clap::Args;
use isophote::say;
use processors::golden::{GOLDENS, Golden};
use processors::hashes;
use std::path::PathBuf;
use techniques::fragment::Fragment;

/// Write the goldens of the CPU rasterizer and the ray caster anew; nothing else may write them
#[derive(Debug, Args)]
pub struct BlessArgs {
    /// Only the G-buffer of the scene of this name, and no hashes
    scene: Option<String>,
}

/// Where goldens lie.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../testdata/golden")
}

/// Where the G-buffer of one lies.
pub fn path(golden: &Golden) -> PathBuf {
    folder().join(format!("{}.npz", golden.name))
}

/// Where the hashes lie.
pub fn hashes_path() -> PathBuf {
    folder().join("hashes.txt")
}

/// Runs the command.
///
/// # Errors
/// Where there is no such scene, or a file cannot be written.
pub fn run(args: &BlessArgs) -> Result<()> {
    let chosen: Vec<&Golden> =
        GOLDENS.iter().filter(|golden| args.scene.as_deref().is_none_or(|name| name == golden.name)).collect();
    let names = || GOLDENS.iter().map(|golden| golden.name).collect::<Vec<_>>().join(", ");
    chosen.first().with_context(|| format!("no such golden; there are {}", names()))?;
    for golden in chosen {
        let path = path(golden);
        golden.raster(&golden.model(), &Fragment).write_npz(&path)?;
        say!("{}: {} bytes", golden.name, std::fs::metadata(&path)?.len())?;
    }
    if args.scene.is_none() {
        let lines: Vec<String> = hashes::lines().map(|line| line + "\n").collect();
        std::fs::write(hashes_path(), lines.concat())?;
        say!("{} hashes", lines.len())?;
    }
    Ok(())
}
