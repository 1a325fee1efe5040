//! Results as tables in Markdown.

use super::analysis::{Analysis, SceneResult};
use super::reach::MEASURES;
use super::table;

/// The tables of a run: one of all scenes, then every scene's own.
pub fn render(analysis: &Analysis) -> String {
    let mut text = format!("# Error against time\n\nMachine: {}\n", analysis.machine.line());
    text += &reach(analysis);
    for scene in &analysis.scenes {
        text += &format!(
            "\n## {}\n\n{} × {} pixels, reference `{}`.\n\n",
            scene.scene,
            scene.size[0],
            scene.size[1],
            scene.reference.display()
        );
        if let Some(noise) = scene.noise {
            text += &format!("Every error includes the {noise}.\n\n");
        }
        text += &points(scene);
    }
    analysis.notes.iter().for_each(|note| text += &format!("\n{note}.\n"));
    analysis.skipped.iter().for_each(|s| text += &format!("\nSkipped: `{}`: {}\n", s.config, s.reason));
    text
}

/// What the table of all scenes shows.
pub const REACH: &str = "CPU time after which the first configuration has the error that the other one has at its largest \
                         budget. `<`: the smallest budget is already better. `≈`: extrapolated beyond the largest budget. \
                         `>`: not reached, and the error no longer falls. Medians over seeds.";

/// The table of all scenes; nothing with only one configuration.
fn reach(analysis: &Analysis) -> String {
    if analysis.scenes.iter().all(|scene| scene.reach.is_empty()) {
        return String::new();
    }
    let names: Vec<&str> = MEASURES.iter().map(|(name, _)| *name).collect();
    let mut text = format!(
        "\n## Reach\n\n{REACH}\n\n| scene | first | other | its CPU s | {} |\n|---|---|---|--:|{}\n",
        names.join(" | "),
        "--:|".repeat(names.len())
    );
    for scene in &analysis.scenes {
        let first = scene.rows.first().map_or("", |row| row.config.as_str());
        for beside in &scene.reach {
            let times: Vec<String> = beside.reached.iter().map(|r| table::reach(r.reach)).collect();
            text += &format!(
                "| {} | {first} | {} | {:.2} | {} |\n",
                scene.scene,
                beside.config,
                beside.cpu_seconds,
                times.join(" | ")
            );
        }
    }
    text
}

fn points(scene: &SceneResult) -> String {
    let names: Vec<&str> = table::COLUMNS.iter().map(|(name, _)| *name).collect();
    let mut text = format!(
        "| configuration | budget | {} |\n|---|--:|{}\n",
        names.join(" | "),
        "--:|".repeat(names.len())
    );
    for row in &scene.rows {
        for p in &row.points {
            text += &format!("| {} | {} | {} |\n", row.config, p.budget, table::cells(p).join(" | "));
        }
        for stopped in &row.stopped {
            text += &format!(
                "| {} | {} | {stopped} |{}\n",
                row.config,
                stopped.budget,
                " |".repeat(names.len() - 1)
            );
        }
    }
    text += "\n";
    for row in scene.rows.iter().filter(|row| row.rmse_slope.is_some()) {
        text += &format!("* {}: {}\n", row.config, table::slope(row));
    }
    text
}
