//! The HTML page of a run: one file that needs no other.

use super::analysis::{Analysis, Point, Row, SceneResult};
use super::error::BenchError;
use super::plot::{Plot, Series};
use super::reach::MEASURES;
use super::record::{Budget, Record};
use super::statistics::Spread;
use super::{markdown, table, thumbnail};
use crate::compare::load;
use crate::html::escape;
use crate::pixels::Pixels;
use std::path::Path;

const STYLE: &str = "body{font:15px/1.45 sans-serif;max-width:1150px;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;margin:1em 0}th,td{padding:3px 10px;text-align:right;border-bottom:1px solid #ddd}\
th:first-child,td:first-child{text-align:left}td{white-space:nowrap}svg{display:block;margin:1em 0;max-width:100%;height:auto}\
.pictures{display:flex;flex-wrap:wrap;gap:14px}figure{margin:0;max-width:260px}figcaption{font-size:13px;\
overflow-wrap:anywhere}img{image-rendering:pixelated;width:256px}.machine{background:#f3f3f3;padding:.5em .8em}\
code{background:#f3f3f3;padding:0 3px}";

/// The HTML; `truths` are the references in the order of the scenes, `folder` is that of the run.
///
/// # Errors
/// A picture cannot be read or encoded.
pub fn render(analysis: &Analysis, truths: &[Pixels], folder: &Path) -> Result<String, BenchError> {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>caustica bench</title>\
         <style>{STYLE}</style></head><body>\n<h1>Error against time</h1>\n"
    );
    let machine = format!("<p class=\"machine\">Machine: {}</p>\n", escape(&analysis.machine.line()));
    html += &reach_of_all(analysis);
    for (scene, truth) in analysis.scenes.iter().zip(truths) {
        html += &format!(
            "<h2>{}</h2>\n{machine}<p>{} × {} pixels, box filter; reference <code>{}</code>. Times are of the \
             render without loading; CPU time is that of all threads. Values are medians over seeds; ± is half the distance between the quartiles. \
             Small dots are single renders.</p>\n",
            escape(&scene.scene),
            scene.size[0],
            scene.size[1],
            escape(&scene.reference.display().to_string())
        );
        if scene.left_out > 0 {
            html += &format!("<p>{} pixels are masked out.</p>\n", scene.left_out);
        }
        if let Some(noise) = scene.noise {
            html += &format!("<p>Every error includes the {noise}.</p>\n");
        }
        for (title, f) in METRICS {
            html += &plot(scene, title, f, CPU).svg();
        }
        html += &plot(scene, "RMSE", |r| r.rmse, WALL).svg();
        html += &reach_table(scene);
        html += &points_table(scene);
        html += &pictures(scene, truth, folder)?;
    }
    for note in &analysis.notes {
        html += &format!("<p>{}.</p>\n", escape(note));
    }
    if !analysis.skipped.is_empty() {
        html += "<h2>Skipped</h2>\n<ul>\n";
        for s in &analysis.skipped {
            html += &format!("<li><code>{}</code>: {}</li>\n", escape(&s.config), escape(&s.reason));
        }
        html += "</ul>\n";
    }
    html += "</body></html>\n";
    Ok(html)
}

type Metric = fn(&Record) -> f64;
const METRICS: [(&str, Metric); 4] = [
    ("RMSE", |r| r.rmse),
    ("relMSE", |r| r.relmse),
    ("relMSE trimmed", |r| r.relmse_trimmed),
    ("LDR-FLIP", |r| r.flip),
];

/// What runs along the x axis: its name in titles, its label, and its value.
type Abscissa = (&'static str, &'static str, Metric);
const WALL: Abscissa = ("wall time", "wall time of the render [s]", |r| r.seconds);
const CPU: Abscissa = ("CPU time", "processor time of all threads [s]", |r| r.cpu_seconds);

fn plot(scene: &SceneResult, title: &str, f: Metric, (time, axis, x): Abscissa) -> Plot {
    let series = |row: &Row| {
        let median = |p: &Point| {
            let here = row.records.iter().filter(|r| r.budget == p.budget);
            let of = |f: Metric| Spread::of(&here.clone().map(f).collect::<Vec<_>>()).median;
            (of(x), of(f))
        };
        let mut line: Vec<(f64, f64)> = row.points.iter().map(median).collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series {
            name: row.title(),
            line,
            dots: row.records.iter().map(|r| (x(r), f(r))).collect(),
            smooth: false,
        }
    };
    Plot {
        title: format!("{}: {title} against {time}", scene.scene),
        x: axis.to_owned(),
        y: title.to_owned(),
        log: [true, true],
        series: scene.rows.iter().map(series).collect(),
    }
}

fn reach_table(scene: &SceneResult) -> String {
    let Some(error) = scene.target_rmse else { return String::new() };
    let mut html = format!(
        "<h3>CPU time to RMSE {error:.5}</h3>\n<table><tr><th>configuration</th><th>time</th><th>ratio to the first (95 % \
         interval over seeds)</th><th>fitted slope</th></tr>\n"
    );
    for row in &scene.rows {
        html += &format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            escape(&row.config),
            escape(&table::reach(row.reach)),
            table::ratio(row.ratio),
            table::slope(row)
        );
    }
    html + "</table>\n"
}

fn points_table(scene: &SceneResult) -> String {
    let mut html =
        String::from("<h3>All points</h3>\n<table><tr><th>configuration</th><th>budget</th><th>seeds</th>");
    table::COLUMNS.iter().for_each(|(name, _)| html += &format!("<th>{name}</th>"));
    html += "</tr>\n";
    for row in &scene.rows {
        for p in &row.points {
            html += &format!("<tr><td>{}</td><td>{}</td><td>{}</td>", escape(&row.config), p.budget, p.seeds);
            table::cells(p).iter().for_each(|cell| html += &format!("<td>{cell}</td>"));
            html += "</tr>\n";
        }
        for stopped in &row.stopped {
            html += &format!(
                "<tr><td>{}</td><td>{}</td><td colspan=\"{}\">{stopped}</td></tr>\n",
                escape(&row.config),
                stopped.budget,
                table::COLUMNS.len() + 1
            );
        }
    }
    html + "</table>\n"
}

/// When the first configuration has the error of the others, for all scenes.
fn reach_of_all(analysis: &Analysis) -> String {
    if analysis.scenes.iter().all(|scene| scene.reach.is_empty()) {
        return String::new();
    }
    let mut html = format!(
        "<h2>Reach</h2>\n<p>{}</p>\n<table><tr><th>scene</th><th>first</th><th>other</th><th>its CPU s</th>",
        markdown::REACH.replace('<', "&lt;").replace('>', "&gt;").replace('`', "")
    );
    MEASURES.iter().for_each(|(name, _)| html += &format!("<th>{name}</th>"));
    html += "</tr>\n";
    for scene in &analysis.scenes {
        let first = scene.rows.first().map_or("", |row| row.config.as_str());
        for beside in &scene.reach {
            html += &format!(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.2}</td>",
                escape(&scene.scene),
                escape(first),
                escape(&beside.config),
                beside.cpu_seconds
            );
            for reached in &beside.reached {
                html += &format!("<td>{}</td>", escape(&table::reach(reached.reach)));
            }
            html += "</tr>\n";
        }
    }
    html + "</table>\n"
}

/// The pictures of every configuration at the largest budget that all have.
fn pictures(scene: &SceneResult, truth: &Pixels, folder: &Path) -> Result<String, BenchError> {
    let has = |row: &Row, b: Budget| row.points.iter().any(|p| p.budget == b);
    let budgets = scene.rows.iter().flat_map(|r| r.points.iter().map(|p| p.budget));
    let Some(common) = budgets
        .filter(|b| scene.rows.iter().all(|r| has(r, *b)))
        .max_by(|a, b| size(*a).total_cmp(&size(*b)))
    else {
        return Ok(String::new());
    };
    let mut html = format!("<h3>Pictures at {common}</h3>\n<div class=\"pictures\">\n");
    let mut figure = |pixels: &Pixels, caption: &str| -> Result<(), BenchError> {
        let source = thumbnail::data_uri(pixels, 256)?;
        html += &format!(
            "<figure><img alt=\"\" src=\"{source}\"><figcaption>{}</figcaption></figure>\n",
            escape(caption)
        );
        Ok(())
    };
    figure(truth, "reference")?;
    for row in &scene.rows {
        if let Some(p) = row.points.iter().find(|p| p.budget == common) {
            let caption =
                format!("{}: {:.2} CPU s, RMSE {:.4}", row.config, p.cpu_seconds.median, p.rmse.median);
            figure(&load(&folder.join(&p.image), None)?.pixels, &caption)?;
        }
    }
    Ok(html + "</div>\n")
}

fn size(budget: Budget) -> f64 {
    match budget {
        Budget::CpuSeconds(s) => s,
        Budget::Passes(n) => f64::from(n),
    }
}
