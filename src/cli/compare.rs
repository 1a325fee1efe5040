//! `caustica compare`: two images, or two folders of images, by every metric of `caustica-tools`.

use caustica_tools::compare;

/// Prints the comparison; the exit status is 0 (every threshold holds), 1 (one falls short) or
/// 2 (something could not be compared).
pub fn run(args: &compare::CompareArgs) -> u8 {
    compare::run(args, &mut std::io::stdout().lock()).code()
}
