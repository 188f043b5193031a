//! Numbers that stand for "no reading": overload codes, error codes, marks of a missing value.

/// A code lies this many times farther from zero than every other reading.
const FAR: f64 = 10.0;
/// Codes that one file may use.
const MOST_CODES: usize = 3;
/// Most of a recording that codes can be.
const MOST_SHARE: f64 = 0.5;

/// Least whole number that is a code where it stands once.
const LEAST_WHOLE: f64 = 99.0;

/// True for a value that several readings have to the bit, or a large whole number.
fn is_code(value: f64, readings: usize) -> bool {
    readings > 1 || value.abs() >= LEAST_WHOLE && value.fract() == 0.0
}

/// Samples that hold a code, one list a code: ten times farther from zero than any other reading.
pub(super) fn found(values: &[f64]) -> Vec<Vec<usize>> {
    let mut codes: Vec<Vec<usize>> = Vec::new();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].abs().total_cmp(&values[*a].abs()));
    let mut rest = order.as_slice();
    let mut candidates = Vec::new();
    while candidates.len() < MOST_CODES
        && let Some(first) = rest.first()
    {
        let same = rest.iter().take_while(|at| values[**at] == values[*first]).count();
        let (own, others) = rest.split_at(same);
        candidates.push(own.to_vec());
        let next = others.first().map_or(0.0, |at| values[*at].abs());
        let left_out: usize = candidates.iter().map(Vec::len).sum();
        if left_out as f64 > MOST_SHARE * values.len() as f64 {
            break;
        }
        // Only what stands above a gap is no reading; a smaller code may stand between.
        if is_code(values[*first], own.len())
            && next > 0.0
            && values[*first].abs() > FAR * next
            && others.len() > own.len()
        {
            codes.append(&mut candidates);
        }
        rest = others;
    }
    codes.iter_mut().for_each(|own| own.sort_unstable());
    codes
}
