//! Series of numbers as options have them.

use miette::miette;

/// `0.25:4:0.25`, or `1,2.5`: at most so many, of which `(name, unit)` are in messages.
pub(super) fn numbers(option: &str, text: &str, (name, unit): (&str, &str), most: usize) -> miette::Result<Vec<f64>> {
    let bad =
        |what: &str| miette!("{option} is {text}: {what}; expected FROM:TO:STEP or a list such as 1,2.5, in {unit}");
    let number = |part: &str| {
        let value = part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| bad(&format!("\"{part}\" is no number")))
    };
    let list = match text.split(':').collect::<Vec<_>>().as_slice() {
        [from, to, step] => {
            let (from, to, step) = (number(from)?, number(to)?, number(step)?);
            if step <= 0.0 || to < from {
                return Err(bad("the step must be more than 0, and TO at least FROM"));
            }
            let count = ((to - from) / step + 1e-9).floor();
            if count >= most as f64 {
                return Err(bad(&format!("more than {most} {name}")));
            }
            (0..=count as usize).map(|i| from + step * i as f64).collect()
        }
        [_] => text.split(',').map(number).collect::<miette::Result<Vec<_>>>()?,
        _ => return Err(bad("two colons are wanted")),
    };
    if list.len() > most {
        return Err(bad(&format!("more than {most} {name}")));
    }
    Ok(list)
}
