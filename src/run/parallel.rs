//! Sessions side by side, each on a thread of its own from beginning to end.
//!
//! Not a parallel iterator of rayon: a worker of rayon that waits for polars' threads takes up the next session in the meantime, on the
//! same stack and with the first one's samples still in memory, and so on. At some thousand sessions the stack is full; a plain thread waits.

use pipeline_base::error::{Error, Result};
use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The result of `work` on every item, in the order of the items; `jobs` at a time, 0 for as many as there are cores.
///
/// # Errors
/// The first error in the order of the items; what has not begun by then is not begun.
pub fn each<T: Sync, R: Send>(
    jobs: usize,
    items: &[T],
    work: impl Fn(&T) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<R>)>> = Mutex::default();
    let worker = || {
        while let Some((k, item)) = take(&next, items) {
            let result = work(item);
            if result.is_err() {
                next.store(items.len(), Ordering::Relaxed);
            }
            if let Ok(mut done) = done.lock() {
                done.push((k, result));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads(jobs).min(items.len()) {
            scope.spawn(worker);
        }
    });
    let mut done = done.into_inner().map_err(Error::internal)?;
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}

fn take<'a, T>(next: &AtomicUsize, items: &'a [T]) -> Option<(usize, &'a T)> {
    let k = next.fetch_add(1, Ordering::Relaxed);
    items.get(k).map(|item| (k, item))
}

fn threads(jobs: usize) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    if jobs == 0 { cores() } else { jobs }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_the_first_error_ends_the_work() {
        let items: Vec<usize> = (0..1000).collect();
        for jobs in [0, 1, 7] {
            let doubled = each(jobs, &items, |k| Ok(2 * k)).unwrap();
            assert!(doubled.iter().zip(&items).all(|(d, k)| *d == 2 * k));
        }
        let begun = AtomicUsize::new(0);
        let fails = each(1, &items, |k| {
            begun.fetch_add(1, Ordering::Relaxed);
            if *k < 3 {
                Ok(())
            } else {
                Err(Error::Usage(k.to_string()))
            }
        });
        assert!(matches!(fails, Err(Error::Usage(k)) if k == "3"));
        assert_eq!(begun.into_inner(), 4);
        assert!(
            each(0, &Vec::<usize>::new(), |k| Ok(*k))
                .unwrap()
                .is_empty()
        );
    }
}
