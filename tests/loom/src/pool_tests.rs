use loom::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use loom::sync::{Arc, Mutex};
use loom::thread;

use crate::pools::Pools;

/// Both may make one: the list is free meanwhile.
#[test]
fn two_threads_that_ask_for_a_pool_get_the_same_one() {
    loom::model(|| {
        let pools = Arc::new(Pools { made: Mutex::new(Vec::new()) });
        let built = Arc::new(AtomicUsize::new(0));
        let get = |pools: &Pools<usize>, built: &AtomicUsize| {
            *pools.get(1, 2, || Some(built.fetch_add(1, Relaxed))).unwrap()
        };
        let other = {
            let (pools, built) = (Arc::clone(&pools), Arc::clone(&built));
            thread::spawn(move || get(&pools, &built))
        };
        let mine = get(&pools, &built);
        assert_eq!(mine, other.join().unwrap());
        assert!(built.load(Relaxed) <= 2 && pools.made.lock().unwrap().len() == 1);
    });
}

#[test]
fn a_pool_that_could_not_be_made_is_made_by_the_next_thread_that_asks() {
    loom::model(|| {
        let pools = Arc::new(Pools { made: Mutex::new(Vec::new()) });
        let other = {
            let pools = Arc::clone(&pools);
            thread::spawn(move || pools.get(1, 2, || None::<usize>).is_some())
        };
        let mine = pools.get(1, 2, || Some(7));
        // The one that cannot make it gets it where it is there already.
        let found = other.join().unwrap();
        assert_eq!(mine.map(|pool| *pool), Some(7));
        assert!(pools.get(1, 2, || None).is_some() && (found || pools.made.lock().unwrap().len() == 1));
    });
}

#[test]
fn a_pool_that_a_thread_has_stays_while_another_asks_for_more_than_are_kept() {
    loom::model(|| {
        let pools = Arc::new(Pools { made: Mutex::new(Vec::new()) });
        let other = {
            let pools = Arc::clone(&pools);
            thread::spawn(move || (3..7).for_each(|size| drop(pools.get(1, size, || Some(size)).unwrap())))
        };
        let mine = pools.get(1, 2, || Some(2)).unwrap();
        assert!(Arc::ptr_eq(&mine, &pools.get(1, 2, || Some(0)).unwrap()));
        other.join().unwrap();
        drop(mine);
        assert_eq!(pools.made.lock().unwrap().len(), 4);
    });
}
