//! Work on as many threads as there are cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Does something with every item; results with the places of their items, in any order.
///
/// These are threads of their own and not of rayon's pool: what an item solves it solves in the pool, and while it
/// waits for that, with the shared models locked, a thread of the pool would take up the next item and wait for
/// the same lock.
pub fn on_all_cores<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<(usize, R)> {
    let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(at) else { break };
            let result = of(item);
            results.lock().unwrap_or_else(PoisonError::into_inner).push((at, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(work);
        }
    });
    results.into_inner().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_done_once() {
        let mut done = on_all_cores(&[3, 5, 7], |n| n * n);
        done.sort_unstable();
        assert_eq!(done, [(0, 9), (1, 25), (2, 49)]);
        assert!(on_all_cores(&[0; 0], |n| *n).is_empty());
    }
}
