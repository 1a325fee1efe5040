//! Whether the document's observation holds, in a sentence made from the measurements.

use super::measure::Measured;

/// The sentence of a study. It says so if there are too few measurements.
pub fn sentence(study: &str, rows: &[Measured]) -> String {
    let made = match study {
        "photons" => photons(rows),
        "neighbours" => neighbours(rows),
        "kernels" => kernels(rows),
        "roulette" => roulette(rows),
        "direct" => direct(rows),
        "nee" => nee(rows),
        "caustic-map" => caustic_map(rows),
        _ => None,
    };
    made.unwrap_or_else(|| "There are too few measurements to say.".to_owned())
}

fn holds(yes: bool) -> &'static str {
    if yes { "**Holds**" } else { "**Does not hold here**" }
}

fn best<'a>(rows: impl IntoIterator<Item = &'a Measured>, f: fn(&Measured) -> f64) -> Option<&'a Measured> {
    rows.into_iter().min_by(|a, b| f(a).total_cmp(&f(b)))
}

/// Relative differences below this may be noise, with so few seeds.
const DOUBT: f64 = 0.02;

/// Compares RMSE `a` with `b`, in words that go before the name of `b`.
fn against(a: f64, b: f64) -> &'static str {
    match a / b - 1.0 {
        d if d > DOUBT => "a higher RMSE than",
        d if d < -DOUBT => "a lower RMSE than",
        _ => "the same RMSE as",
    }
}

fn photons(rows: &[Measured]) -> Option<String> {
    let (first, last) = (rows.first()?, rows.last()?);
    let exponent = (last.cpu_seconds / first.cpu_seconds).ln() / (last.x / first.x).ln();
    Some(format!(
        "{}: from {} to {} light paths bias falls from {:.4} to {:.4} and noise from {:.4} to {:.4}, because \
         the 100 nearest photons lie in a smaller disc. Every estimate still uses 100 photons; noise falls \
         because the smaller discs of a pixel's 16 rays overlap less. Time grows with the power {exponent:.2} \
         of the number of paths: {}.",
        holds(last.rmse < first.rmse && last.bias_rms < first.bias_rms),
        first.label,
        last.label,
        first.bias_rms,
        last.bias_rms,
        first.noise_rms,
        last.noise_rms,
        if exponent < 0.95 { "more slowly than that number" } else { "about in proportion to it" }
    ))
}

fn neighbours(rows: &[Measured]) -> Option<String> {
    let (least, most) = (rows.first()?, rows.last()?);
    let (rmse, flip) = (best(rows, |m| m.rmse)?, best(rows, |m| m.flip)?);
    let straight = best(rows, |m| m.bias_rms)?;
    let hundred = rows.iter().find(|m| m.x == 100.0)?;
    Some(format!(
        "{}: bias is least with {} ({:.4}) and grows to {:.4} ({}), noise falls from {:.4} ({}) to {:.4}; 500 \
         neighbours give {} 100 ({:.4} against {:.4}). The balance the document asks for lies at {} for RMSE \
         and {} for FLIP. CPU time does depend on them: {:.1} times as long for {} as for {}.",
        holds(
            most.bias_rms > straight.bias_rms
                && most.noise_rms < least.noise_rms
                && most.rmse >= (1.0 - DOUBT) * hundred.rmse
        ),
        straight.label,
        straight.bias_rms,
        most.bias_rms,
        most.label,
        least.noise_rms,
        least.label,
        most.noise_rms,
        against(most.rmse, hundred.rmse),
        most.rmse,
        hundred.rmse,
        rmse.label,
        flip.label,
        most.cpu_seconds / least.cpu_seconds,
        most.label,
        least.label
    ))
}

fn kernels(rows: &[Measured]) -> Option<String> {
    let of = |kernel: &str| rows.iter().filter(|m| m.group == kernel).collect::<Vec<_>>();
    let (gauss, epan) = (of("gaussian"), of("epanechnikov"));
    let (g, e) = (best(gauss.iter().copied(), |m| m.flip)?, best(epan.iter().copied(), |m| m.flip)?);
    let (gr, er) = (best(gauss.iter().copied(), |m| m.rmse)?, best(epan.iter().copied(), |m| m.rmse)?);
    let small = |rows: &[&Measured]| rows.first().map(|m| (m.bias_rms, m.noise_rms, m.flip));
    let ((gb, gn, gf), (eb, en, ef)) = (small(&gauss)?, small(&epan)?);
    let difference = 100.0 * (g.flip / e.flip - 1.0);
    let noise = |kernel: &str| of(kernel).first().map(|m| m.noise_rms);
    let smooth = ["gaussian", "epanechnikov", "logistic", "constant"].map(noise);
    let sharp = ["biweight", "cone"].map(noise);
    let loudest = smooth.into_iter().collect::<Option<Vec<_>>>()?.into_iter().fold(0.0, f64::max);
    let quietest = sharp.into_iter().collect::<Option<Vec<_>>>()?.into_iter().fold(f64::INFINITY, f64::min);
    let groups = if loudest < quietest {
        "**Holds** too: at one radius the four smooth more than biweight and cone".to_owned()
    } else {
        format!(
            "**Does not hold here** that they are the smoothing ones: at one radius the noisiest of the four \
             has a noise of {loudest:.4} and the less noisy of biweight and cone has {quietest:.4}, because the \
             Gaussian and the logistic, which end at 3σ, are narrower"
        )
    };
    let word = if difference < -2.0 {
        holds(true)
    } else if difference > 2.0 {
        holds(false)
    } else {
        "**Does not hold once each kernel has its own best radius**: they are equal"
    };
    Some(format!(
        "{word}. At one radius ({}) the Gaussian has less bias and more noise than Epanechnikov (bias {gb:.4} \
         against {eb:.4}, noise {gn:.4} against {en:.4}, FLIP {gf:.4} against {ef:.4}), as a narrower kernel \
         must. With each at its best radius, FLIP is {:.4} ({}) against {:.4} ({}), a difference of \
         {difference:+.1} %, and RMSE {:.4} against {:.4}: the choice of radius matters more than the kernel's \
         shape. {groups}.",
        epan.first()?.x,
        g.flip,
        g.label,
        e.flip,
        e.label,
        gr.rmse,
        er.rmse
    ))
}

fn roulette(rows: &[Measured]) -> Option<String> {
    let find = |policy: &str, rays: f64| rows.iter().find(|m| m.group == policy && m.x == rays);
    let (a1, a16) = (find("absorb", 1.0)?, find("absorb", 16.0)?);
    let (r1, r16) = (find("renormalise", 1.0)?, find("renormalise", 16.0)?);
    let (t1, t16) = (find("retry", 1.0)?, find("retry", 16.0)?);
    let black = a1.black > r1.black + 1e-4;
    Some(format!(
        "Black pixels at 1 ray: {} ({:.2} % with absorption, {:.2} % and {:.2} % with retry and renormalise). \
         Darker at 16 rays: {}: the mean differs from the reference by {:+.2} %, {:+.2} % and {:+.2} %, and \
         absorption that weights make up for adds noise, not darkness. RMSE at 1 ray {:.4}, {:.4} and {:.4}. \
         Renormalising costs nothing: {} ({:.2}, {:.2} and {:.2} CPU s at 16 rays; absorbed paths look up no \
         photons).",
        holds(black),
        100.0 * a1.black,
        100.0 * t1.black,
        100.0 * r1.black,
        holds(a16.mean_bias < r16.mean_bias - 0.005),
        100.0 * a16.mean_bias,
        100.0 * t16.mean_bias,
        100.0 * r16.mean_bias,
        a1.rmse,
        t1.rmse,
        r1.rmse,
        match (r16.cpu_seconds / t16.cpu_seconds, r16.cpu_seconds / a16.cpu_seconds) {
            (_, a) if a < 1.0 + 5.0 * DOUBT => "**holds**",
            (t, _) if t < 1.0 + 5.0 * DOUBT => "**holds** against trying again, not against absorption",
            _ => "**does not hold here**",
        },
        a16.cpu_seconds,
        t16.cpu_seconds,
        r16.cpu_seconds
    ))
}

fn direct(rows: &[Measured]) -> Option<String> {
    let with = rows.iter().find(|m| m.group == "NEE")?;
    let without = rows.iter().filter(|m| m.group == "first photons").max_by(|a, b| a.x.total_cmp(&b.x))?;
    let times = without.cpu_seconds / with.cpu_seconds;
    Some(format!(
        "Less time: {} ({:.2} CPU s against {:.2} with {} light paths, {times:.1} times as long). Better: {}: \
         RMSE {:.4} against {:.4}, bias {:.4} against {:.4}, because no disc blurs shadows and corners. Darker: \
         {}: the means differ by {:+.2} % with NEE and {:+.2} % with photons from the reference. Both include \
         the same cosine, the photons through their density.",
        holds(times > 2.0),
        with.cpu_seconds,
        without.cpu_seconds,
        without.x,
        holds(with.rmse < (1.0 - DOUBT) * without.rmse),
        with.rmse,
        without.rmse,
        with.bias_rms,
        without.bias_rms,
        holds(with.mean_bias < without.mean_bias - 0.01),
        100.0 * with.mean_bias,
        100.0 * without.mean_bias
    ))
}

fn nee(rows: &[Measured]) -> Option<String> {
    let of = |group: &str, x: f64| rows.iter().find(|m| m.group == group && m.x == x);
    let xs = || rows.iter().map(|m| m.x);
    let (least, most) = (xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max));
    let (with, without) = (of("NEE", most)?, of("first photons", most)?);
    let (few, few_without) = (of("NEE", least)?, of("first photons", least)?);
    let time = with.cpu_seconds / without.cpu_seconds;
    Some(format!(
        "Better: {}: with {most} light paths bias is {:.4} with NEE instead of {:.4} and RMSE {:.4} instead of \
         {:.4}; with {least}, RMSE is {:.4} instead of {:.4}. Less time: {}: {:.2} CPU s with NEE, {:.2} \
         without, because both look up photons for the indirect light.",
        holds(with.rmse < (1.0 - DOUBT) * without.rmse),
        with.bias_rms,
        without.bias_rms,
        with.rmse,
        without.rmse,
        few.rmse,
        few_without.rmse,
        holds(time < 0.5),
        with.cpu_seconds,
        without.cpu_seconds
    ))
}

fn caustic_map(rows: &[Measured]) -> Option<String> {
    let find = |label: &str| rows.iter().find(|m| m.label == label);
    let alone = find("global map alone")?;
    let (own, capped) = (find("caustic r = 0.025")?, find("caustic r = 0.025, cap 20")?);
    let cap = if (capped.rmse / own.rmse - 1.0).abs() < DOUBT {
        "**hardly changes anything here**, where discs seldom hold that many photons"
    } else {
        holds(capped.rmse < own.rmse)
    };
    let (first, equal) = (best(rows, |m| m.rmse)?, find("caustic r = 0.025, equal photons")?);
    Some(format!(
        "{}: with a caustic map of radius 0.025 RMSE is {:.4} → {:.4} and bias {:.4} → {:.4}; the gain comes \
         from its own light paths: with no more caustic photons than the single map has, RMSE is {:.4}. The cap \
         of 20: {}: RMSE {:.4}, bias {:.4}, noise {:.4} against {:.4}; taking only the nearest photons shrinks \
         the disc where caustics are bright, which sharpens and does not darken them (the mean differs by \
         {:+.2} % with it, {:+.2} % without). The lowest RMSE is that of {} ({:.4}).",
        holds(own.rmse < (1.0 - DOUBT) * alone.rmse),
        alone.rmse,
        own.rmse,
        alone.bias_rms,
        own.bias_rms,
        equal.rmse,
        cap,
        capped.rmse,
        capped.bias_rms,
        capped.noise_rms,
        own.noise_rms,
        100.0 * capped.mean_bias,
        100.0 * own.mean_bias,
        first.label,
        first.rmse
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_measured_says_so() {
        for name in super::super::catalogue::NAMES {
            assert!(sentence(name, &[]).starts_with("There are too few"), "{name}");
        }
    }
}
