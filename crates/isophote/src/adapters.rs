//! `adapters`: which GPUs there are, and to which grid each snaps corners, measured now.

use crate::format::Format;
use crate::{say, terminal};
use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use serde_json::json;

/// List the GPU adapters of this machine, software ones too
#[derive(Debug, Args)]
pub struct AdaptersArgs {
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
///
/// # Errors
/// Where there is no adapter: the message names the line that installs a software one.
pub fn run(args: &AdaptersArgs) -> Result<()> {
    let adapters = gpu::adapters();
    match args.format {
        Format::Json => {
            let list: Vec<_> = adapters
                .iter()
                .map(|a| {
                    json!({
                        "name": a.name, "kind": format!("{:?}", a.kind), "driver": a.driver,
                        "driver_info": a.driver_info, "backend": a.backend,
                        "grid": measured(a).ok().flatten().map(|grid| json!({
                            "bits": grid.bits, "rounding": match grid.rounding {
                                gpu::Rounding::Nearest => "nearest",
                                gpu::Rounding::OneWay => "one way",
                            },
                        })),
                    })
                })
                .collect();
            terminal::json(&json!({ "adapters": list }))?;
        }
        Format::Table if adapters.is_empty() => say!("none; {}", gpu::remedy(std::env::consts::OS))?,
        Format::Table => {
            let mut table = Table::new();
            table.load_style(UTF8_FULL_CONDENSED);
            table.set_header(["adapter", "kind", "driver", "back end", "corners go to"]);
            for a in &adapters {
                let driver = format!("{} {}", a.driver, a.driver_info);
                let grid = match measured(a) {
                    Ok(Some(grid)) => grid.to_string(),
                    Ok(None) => "no grid that was found".to_owned(),
                    Err(error) => format!("not measured: {error}"),
                };
                table.add_row([a.name.clone(), format!("{:?}", a.kind), driver, a.backend.clone(), grid]);
            }
            terminal::table(&table)?;
        }
    }
    Ok(())
}

/// The grid to which an adapter snaps corners; of several with one name it is the first one's.
fn measured(adapter: &gpu::AdapterInfo) -> Result<Option<gpu::Grid>, gpu::GpuError> {
    gpu::Device::open(Some(&adapter.name))?.measured_grid()
}
