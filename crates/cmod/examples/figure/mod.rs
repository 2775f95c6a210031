//! Figures of the examples.
#![allow(dead_code, reason = "each example uses what it needs")]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

/// Title, axes and legend of a panel.
pub(crate) fn layout(plots: &[Plot], title: &str, [x, y]: [&str; 2]) -> Layout {
    Layout::auto_from_plots(plots)
        .with_title(title)
        .with_x_label(x)
        .with_y_label(y)
        .with_legend_position(LegendPosition::InsideTopRight)
}

/// Writes the figure to `target/examples` and returns its path.
pub(crate) fn written(figure: Figure, name: &str) -> Result<PathBuf, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .ok_or("the crate lies in the folder crates of its workspace")?;
    let folder = workspace.join("target/examples");
    fs::create_dir_all(&folder)?;
    let path = folder.join(name);
    fs::write(&path, SvgBackend::default().render_scene(&figure.render()))?;
    Ok(path)
}
