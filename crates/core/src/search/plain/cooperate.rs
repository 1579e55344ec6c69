//! Chains on several threads that meet to share the best plan.
//!
//! Threads wait for each other at fixed shares of the effort, so that with an iteration limit the outcome depends on the number
//! of threads, but not on their speed.

use super::state::State;
use crate::search::objective::Rank;
use std::sync::{Barrier, Mutex, PoisonError};

/// Where the threads of one search meet.
pub(super) struct Meeting {
    barrier: Barrier,
    /// Rank and plan each thread brings.
    plans: Mutex<Vec<Option<(Rank, State)>>>,
}

impl Meeting {
    pub fn new(num_threads: usize) -> Self {
        Self { barrier: Barrier::new(num_threads), plans: Mutex::new(vec![None; num_threads]) }
    }

    /// Waits for all threads, and says which plan is better than the one this thread brings: the best, the first of equals. Up to
    /// the cost `free` the longest route does not matter.
    pub fn best_of_all(&self, thread: usize, brought: &State, free: f64) -> Option<State> {
        let lock = || self.plans.lock().unwrap_or_else(PoisonError::into_inner);
        if lock().len() == 1 {
            return None;
        }
        let rank = Rank::of(brought.costs()).free_up_to(free);
        lock()[thread] = Some((rank, brought.clone()));
        self.barrier.wait();
        let best = lock().iter().flatten().min_by(|a, b| a.0.compare(&b.0)).cloned();
        self.barrier.wait();
        best.filter(|best| best.0.is_better(&rank)).map(|best| best.1)
    }
}
