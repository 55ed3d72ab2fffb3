//! Circles among arrows.

use std::collections::{BTreeMap, VecDeque};

/// What points at what, and something that is known of each arrow.
pub type Arrows<N, A> = BTreeMap<N, BTreeMap<N, A>>;

/// For each arrow from which a way leads back, unless a circle named before has it: the shortest circle with it, from
/// its tail back to its tail.
pub fn circles<N: Ord + Clone, A>(arrows: &Arrows<N, A>) -> Vec<Vec<N>> {
    let mut found: Vec<Vec<N>> = Vec::new();
    for (tail, heads) in arrows {
        for head in heads.keys() {
            let named = found.iter().any(|circle| circle.windows(2).any(|pair| pair[0] == *tail && pair[1] == *head));
            if let Some(path) = (!named).then(|| shortest(arrows, head, tail)).flatten() {
                found.push([vec![tail.clone()], path].concat());
            }
        }
    }
    found
}

/// The shortest way from one to another, both among it.
fn shortest<N: Ord + Clone, A>(arrows: &Arrows<N, A>, from: &N, to: &N) -> Option<Vec<N>> {
    let mut before: BTreeMap<&N, Option<&N>> = BTreeMap::from([(from, None)]);
    let mut next = VecDeque::from([from]);
    while let Some(at) = next.pop_front() {
        if at == to {
            let mut path = vec![at.clone()];
            let mut last = at;
            while let Some(Some(previous)) = before.get(last) {
                path.push((*previous).clone());
                last = previous;
            }
            path.reverse();
            return Some(path);
        }
        for head in arrows.get(at).into_iter().flat_map(BTreeMap::keys) {
            if !before.contains_key(head) {
                before.insert(head, Some(at));
                next.push_back(head);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(arrows: &[(char, char)]) -> Vec<String> {
        let mut drawn = Arrows::new();
        for &(tail, head) in arrows {
            drawn.entry(tail).or_insert_with(BTreeMap::new).insert(head, ());
        }
        circles(&drawn).into_iter().map(|circle| circle.into_iter().collect()).collect()
    }

    #[test]
    fn what_only_leads_away_makes_no_circle() {
        assert!(drawn(&[('a', 'b'), ('a', 'c'), ('b', 'd'), ('c', 'd')]).is_empty());
    }

    #[test]
    fn each_circle_is_named_once_and_every_arrow_of_one_is_in_it() {
        assert_eq!(drawn(&[('a', 'b'), ('b', 'a'), ('b', 'c'), ('c', 'b'), ('c', 'd')]), ["aba", "bcb"]);
        assert_eq!(drawn(&[('a', 'b'), ('b', 'c'), ('c', 'a'), ('b', 'a')]), ["aba", "bcab"]);
    }
}
