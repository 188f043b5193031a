//! What can be done to a recording whose sensor erred.

use crate::experiment::Recording;

impl Recording {
    /// Every column that has samples.
    pub(in crate::experiment) fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let own = [&mut self.time_s, &mut self.depth_mm, &mut self.force_n];
        own.into_iter().chain(self.others.values_mut()).filter(|values| !values.is_empty())
    }

    /// Takes samples out; `at` rises.
    pub(super) fn leave_out(&mut self, at: &[usize]) {
        for values in self.columns() {
            *values = kept(values, at);
        }
        self.line = kept(&self.line, at);
    }

    /// Ends before a sample.
    pub(super) fn end_before(&mut self, at: usize) {
        self.columns().for_each(|values| values.truncate(at));
        self.line.truncate(at);
    }

    /// Turns depth and force about.
    pub(in crate::experiment) fn turn(&mut self) {
        self.force_n.iter_mut().chain(&mut self.depth_mm).for_each(|value| *value = -*value);
    }
}

fn kept<T: Copy>(values: &[T], without: &[usize]) -> Vec<T> {
    let stays = |(at, _): &(usize, &T)| without.binary_search(at).is_err();
    values.iter().enumerate().filter(stays).map(|(_, value)| *value).collect()
}
