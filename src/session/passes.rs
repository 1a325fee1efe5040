//! Ranges of passes: which are there, which are missing.

/// "0..64, 128..192", each from the first pass to the one after the last.
pub fn listed(ranges: &[[u32; 2]]) -> String {
    ranges.iter().map(|[first, end]| format!("{first}..{end}")).collect::<Vec<_>>().join(", ")
}

/// Whether two ranges have a pass in common.
pub fn overlap(a: [u32; 2], b: [u32; 2]) -> bool {
    a[0].max(b[0]) < a[1].min(b[1])
}

/// What ranges that do not overlap leave of the passes 0..`whole`.
pub fn missing(mut ranges: Vec<[u32; 2]>, whole: u32) -> Vec<[u32; 2]> {
    ranges.sort_unstable();
    let mut missing = Vec::new();
    let mut next = 0;
    for [first, end] in ranges {
        if first > next {
            missing.push([next, first.min(whole)]);
        }
        next = next.max(end);
    }
    missing.push([next, whole]);
    missing.retain(|[first, end]| first < end);
    missing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_all_that_no_range_holds() {
        assert_eq!(missing(vec![], 5), [[0, 5]]);
        assert_eq!(missing(vec![[3, 4], [0, 2]], 6), [[2, 3], [4, 6]]);
        assert_eq!(missing(vec![[0, 2], [2, 6]], 6), Vec::<[u32; 2]>::new());
        assert_eq!(missing(vec![[4, 9]], 3), [[0, 3]]);
        assert_eq!(listed(&missing(vec![[1, 2]], 4)), "0..1, 2..4");
    }
}
