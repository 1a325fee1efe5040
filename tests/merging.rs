//! Parts of a render, merged, are the render.

use std::ops::Range;
use std::path::Path;

use caustica::render::{Budget, Sums};
use caustica::sampling::mix;
use caustica::session::{Error, Merge, Options, Output, Session};

use crate::support::{box_camera, lamp, plain, sphere, walls};
use caustica_formats::files::Memory;

const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

/// Passes of the whole render.
const PASSES: u32 = 64;

/// A glass sphere in a box, 12 pixels wide, with the settings and layers that are asked for.
fn session(settings: &[(&str, &str)], layers: Option<&str>) -> Session {
    let body = [box_camera(12), walls("0.6"), lamp(0.4, "3"), sphere("0,-0.4,0", 0.5, GLASS)].concat();
    let text = format!("<scene version='3.0.0'>{body}</scene>");
    let files = Memory([("scene.xml".into(), text.into_bytes())].into());
    let own = [("photons", "500"), ("caustic_photons", "500"), ("camera_samples", "1")];
    let settings = own.iter().chain(settings).map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let layers = layers.map(|list| list.parse().unwrap());
    let options = Options { settings, layers, ..plain() };
    Session::open_in(&files, Path::new("scene.xml"), &options).unwrap_or_else(|e| panic!("{e}"))
}

fn threads<T: Send>(n: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(work)
}

/// The part of a render with these passes. With `stopped` it is ended after its first pass, saved, and goes on from there.
fn part(session: &Session, range: Range<u32>, stopped: bool) -> Vec<u8> {
    let outcome = if stopped {
        let begun = session.render_range(range.clone(), Budget::passes(1), &mut |_| {});
        let saved = caustica::render::Checkpoint::decode(&session.part(&begun).unwrap()).unwrap();
        assert_eq!((saved.head.first, saved.head.passes), (range.start, 1));
        let sums = Sums { pixels: saved.pixels, first: range.start, passes: 1 };
        session.resume_range(sums, range.end, Budget::default(), &mut |_| {})
    } else {
        session.render_range(range.clone(), Budget::default(), &mut |_| {})
    };
    assert_eq!(outcome.statistics.passes, range.len() as u32);
    session.part(&outcome).unwrap()
}

/// `count` ranges that make up all passes, not of one length where that can be.
fn split(count: u32) -> Vec<Range<u32>> {
    let at = |i: u32| match i {
        0 => 0,
        i if i == count => PASSES,
        i => i * PASSES / count + u32::from(count < 10) * (i % 3),
    };
    (0..count).map(|i| at(i)..at(i + 1)).collect()
}

fn exr(picture: &caustica::session::Picture<'_>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.exr");
    Output::of(picture.info(), vec![file.clone()]).write(picture).unwrap();
    std::fs::read(file).unwrap()
}

/// One run, and parts on other numbers of threads, some of them stopped and resumed, merged in another order than theirs:
/// the same sums, the same estimate of the error, the same file.
#[test]
fn parts_merged_in_any_order_are_one_run() {
    let path = ("integrator", "path");
    for (settings, layers) in [(vec![], None), (vec![path], Some("all")), (vec![("indirect", "gather")], None)] {
        let session = session(&settings, layers);
        let whole = threads(1, || session.render(Budget::passes(PASSES), &mut |_| {}));
        let error = whole.pixels.relative_error(PASSES);
        let expected = exr(&session.picture(&whole));
        assert!(error.is_finite() && error > 0.0);
        for count in [1, 2, 7, 64] {
            let mut parts: Vec<(u64, Vec<u8>)> = (0..)
                .zip(split(count))
                .map(|(i, range)| {
                    let stopped = range.len() > 1 && i % 2 == 0;
                    (mix(i + 5), threads(1 + i as usize % 2, || part(&session, range, stopped)))
                })
                .collect();
            parts.sort();
            let mut merge = Merge::new();
            for (i, (_, bytes)) in parts.iter().enumerate() {
                merge.add(Path::new(&format!("part {i}")), bytes).unwrap();
            }
            let merged = merge.finish(None, false).unwrap();
            assert_eq!(merged.passes(), PASSES);
            assert_eq!(merged.relative_error().to_bits(), error.to_bits(), "{settings:?}, {count} parts");
            assert!(exr(&merged.picture()) == expected, "{settings:?}, {count} parts");
        }
    }
}
