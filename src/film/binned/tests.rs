use proptest::prelude::*;

use super::*;

/// The sum of one number after another.
fn summed(values: &[f64]) -> BinnedSums {
    let mut sums = BinnedSums::new(1);
    values.iter().for_each(|x| sums.par_chunks_mut(1).for_each(|mut sum| sum.add(&[*x])));
    sums
}

/// Numbers of all sizes, of nearly one size, and those on the border of two digits.
fn number() -> impl Strategy<Value = f64> {
    let border = (-23i64..25, -3i64..4, any::<bool>()).prop_map(|(place, off, negative)| {
        let x = f64::from_bits((power(DIGIT * place - SHIFT - 1).to_bits() as i64 + off) as u64);
        if negative { -x } else { x }
    });
    prop_oneof![
        any::<f64>().prop_filter("finite", |x| x.is_finite() && x.abs() < 1e300),
        -1.0..1.0f64,
        border,
        any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(f64::from),
        Just(0.0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any order and any grouping give the same bits.
    #[test]
    fn sums_have_no_order(
        values in prop::collection::vec(number(), 1..40),
        seed in any::<u64>(),
        cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..4),
    ) {
        let whole = summed(&values);
        let mut shuffled = values.clone();
        let key = |x: &f64| crate::sampling::mix(x.to_bits() ^ seed);
        shuffled.sort_by_key(key);
        prop_assert_eq!(&whole, &summed(&shuffled));
        let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(values.len())).collect();
        cuts.extend([0, values.len()]);
        cuts.sort_unstable();
        let mut parts: Vec<BinnedSums> =
            cuts.windows(2).map(|cut| summed(&shuffled[cut[0]..cut[1]])).collect();
        parts.reverse();
        let mut merged = BinnedSums::new(1);
        parts.iter().for_each(|part| merged.merge(part));
        prop_assert_eq!(&whole, &merged);
    }

    /// Off by 2⁻⁴⁰ of the largest for each number at most. Multiples of 2⁻⁵⁰ below 2²⁰ are added exactly as integers
    /// here; reading the sum rounds it to f64, which 2⁻⁵² of it allows for.
    #[test]
    fn sums_are_as_exact_as_they_say(
        values in prop::collection::vec((-(1i64 << 52)..1 << 52, 0u32..50), 1..40),
    ) {
        let values: Vec<i64> = values.into_iter().map(|(x, shift)| x >> shift).collect();
        let unit = power(-50);
        let exact = values.iter().map(|x| i128::from(*x)).sum::<i128>() as f64 * unit;
        let numbers: Vec<f64> = values.iter().map(|x| *x as f64 * unit).collect();
        let largest = numbers.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let bound = numbers.len() as f64 * power(-40) * largest + exact.abs() * power(-52);
        let sum = summed(&numbers).get(0);
        prop_assert!((sum - exact).abs() <= bound, "{} against {}", sum, exact);
    }

    /// Bytes give the sums again.
    #[test]
    fn packed_sums_are_the_same(rows in prop::collection::vec(prop::collection::vec(number(), 0..5), 1..300)) {
        let mut sums = BinnedSums::new(rows.len());
        for add in 0..5 {
            let values: Vec<f64> = rows.iter().map(|row| row.get(add).copied().unwrap_or(0.0)).collect();
            sums.par_chunks_mut(rows.len()).for_each(|mut sums| sums.add(&values));
        }
        let mut bytes = Vec::new();
        sums.pack(&mut bytes);
        prop_assert!(bytes.len() <= 4 + sums.len() * BinnedSums::PACKED);
        let mut rest = &bytes[..];
        let again = BinnedSums::unpack(sums.len(), &mut rest);
        prop_assert_eq!(again.as_ref(), Some(&sums));
        prop_assert!(rest.is_empty());
    }
}

/// As many of the largest digits as may be added do not overflow.
#[test]
fn the_largest_digits_do_not_overflow() {
    let x = limit(0);
    let mut sums = summed(&[x]);
    assert_eq!((i64::from(sums.top[0]) + LOWEST, sums.high[0]), (0, 1 << (DIGIT - 1)));
    for doubled in 1..=23 {
        let same = sums.clone();
        sums.merge(&same);
        assert_eq!(sums.get(0), x * power(doubled));
    }
    assert_eq!(MOST_ADDITIONS, 1 << 23);
}

/// Also where the exponent is the least.
#[test]
fn the_top_digit_is_the_highest_that_is_not_0() {
    for place in LOWEST + 1..HIGHEST {
        let most = limit(place);
        assert_eq!([top(most), top(-most), top(most / 2.0)], [place; 3]);
        let next = f64::from_bits(most.to_bits() + 1);
        assert_eq!(top(next), place + 1);
    }
    assert_eq!([top(f64::MIN_POSITIVE), top(5e-324), top(limit(LOWEST))], [LOWEST; 3]);
    assert_eq!(top(f64::MAX), HIGHEST);
    assert_eq!([top(1e-6), top(1.0), top(5e5)], [0; 3]);
}

/// A row of one size, one that is not, and one with what is no number, give what their sums give one by one.
#[test]
fn rows_are_added_to_as_their_sums_are() {
    let size = |i: usize| [1.0, 0.0, 1e-3, 7e8, 1e-30][i / ROW];
    let values: Vec<f64> = (0..5 * ROW).map(|i| size(i) * (1.0 + i as f64) * [1.0, -1.0][i % 2]).collect();
    let odd: Vec<f64> =
        values.iter().rev().enumerate().map(|(i, x)| if i == 70 { f64::NAN } else { *x }).collect();
    let mut rows = BinnedSums::new(values.len());
    for values in [&values, &odd, &values] {
        rows.par_chunks_mut(values.len()).for_each(|mut sums| sums.add(values));
    }
    for i in 0..values.len() {
        let mut one = BinnedSums::default();
        one.extend(&rows, i..i + 1);
        assert_eq!(one, summed(&[values[i], odd[i], values[i]]), "{i}");
    }
}

#[test]
fn what_is_not_finite_is_left_out() {
    let odd = [1.5, f64::NAN, f64::INFINITY, -0.25, f64::NEG_INFINITY];
    assert_eq!(summed(&odd), summed(&[-0.25, 1.5]));
    assert_eq!(summed(&odd).get(0), 1.25);
}

/// What f64 sums would lose: the small ones beside the large one, which then goes.
#[test]
fn a_large_number_that_is_taken_back_leaves_the_small_ones() {
    assert_eq!(summed(&[1e9, 1e-9, -1e9]).get(0), summed(&[1e-9, 1e9, -1e9]).get(0));
    assert!((summed(&[1e9, 1e-9, -1e9]).get(0) - 1e-9).abs() <= 3.0 * power(-40) * 1e9);
}
