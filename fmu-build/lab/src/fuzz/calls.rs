//! Target `calls`: structured sequences of calls of the C interface.
//!
//! Every instance of an execution has random numbers of its own, so that it makes the same calls whatever the others do:
//! that none influences another is checked by repeating the first one alone.

mod actor;
mod scenes;

use super::random::Random;
use super::{Kinds, Verdict};
use actor::Actor;

/// Most instances of an execution.
const MOST_INSTANCES: usize = 3;

pub(crate) fn run(seed: u64, kinds: &mut Kinds) -> Verdict {
    let mut random = Random::new(seed, 0);
    let count = if random.one_in(4) { 1 + random.below(MOST_INSTANCES) } else { 1 };
    let mut actors = Vec::new();
    for stream in 1..=count as u64 {
        actors.push(Actor::new(Random::new(seed, stream))?);
    }
    let mut turns = [0; MOST_INSTANCES];
    for _ in 0..count * (10 + random.below(50)) {
        let which = random.below(count);
        turns[which] += 1;
        actors[which].turn(kinds)?;
    }
    let first = actors[0].finish(kinds)?;
    for actor in &mut actors[1..] {
        actor.finish(kinds)?;
    }
    drop(actors);
    if count > 1 || random.one_in(16) {
        let mut alone = Actor::new(Random::new(seed, 1))?;
        for _ in 0..turns[0] {
            alone.turn(kinds)?;
        }
        if alone.finish(kinds)? != first {
            return Err("an instance computes something else when it runs alone a second time".into());
        }
    }
    Ok(())
}
