//! Least spanning trees.

use super::graph::Leg;

/// No pond, or no leg.
pub(super) const NONE: usize = usize::MAX;

/// A least spanning tree of the ponds. Leg l joins the ponds `ends[2 l]` and `ends[2 l + 1]`.
#[derive(Default)]
pub(super) struct Tree {
    ends: Vec<usize>,
    costs: Vec<f64>,
    /// Per pond the first of its places in `ends`, and per place the next of the same pond.
    first_places: Vec<usize>,
    next_places: Vec<usize>,
    is_cut: Vec<bool>,
    groups: Vec<usize>,
    stack: Vec<(usize, usize, usize)>,
}

impl Tree {
    /// Chooses the tree among the candidates and counts its legs in `degrees`; returns its cost. Kruskal's algorithm; of
    /// the dearer candidates it sorts only those that join what the cheaper ones leave apart.
    pub fn grow(&mut self, num_ponds: usize, candidates: &mut [Leg], degrees: &mut [i32]) -> f64 {
        self.ends.clear();
        self.costs.clear();
        self.groups.clear();
        self.groups.extend(0..num_ponds);
        let by_cost =
            |a: &Leg, b: &Leg| a.cost.total_cmp(&b.cost).then((a.nearer, a.farther).cmp(&(b.nearer, b.farther)));
        let num_cheap = (2 * num_ponds).min(candidates.len());
        if num_cheap < candidates.len() {
            candidates.select_nth_unstable_by(num_cheap, by_cost);
        }
        candidates[..num_cheap].sort_unstable_by(by_cost);
        self.join(&candidates[..num_cheap]);
        let joins_groups = |leg: &Leg| self.group(leg.nearer) != self.group(leg.farther);
        let mut dear: Vec<Leg> = candidates[num_cheap..].iter().copied().filter(joins_groups).collect();
        dear.sort_unstable_by(by_cost);
        self.join(&dear);
        for &end in &self.ends {
            degrees[end] += 1;
        }
        self.list_places(num_ponds);
        self.costs.iter().sum()
    }

    fn join(&mut self, legs: &[Leg]) {
        for leg in legs {
            let (one, other) = (self.group(leg.nearer), self.group(leg.farther));
            if one != other {
                self.groups[one] = other;
                self.ends.extend([leg.nearer, leg.farther]);
                self.costs.push(leg.cost);
            }
        }
    }

    fn group(&mut self, mut pond: usize) -> usize {
        while self.groups[pond] != pond {
            self.groups[pond] = self.groups[self.groups[pond]];
            pond = self.groups[pond];
        }
        pond
    }

    fn list_places(&mut self, num_ponds: usize) {
        self.is_cut.clear();
        self.is_cut.resize(self.costs.len(), false);
        self.first_places.clear();
        self.first_places.resize(num_ponds, NONE);
        self.next_places.clear();
        for (place, &pond) in self.ends.iter().enumerate() {
            self.next_places.push(self.first_places[pond]);
            self.first_places[pond] = place;
        }
    }

    /// Cuts a leg and returns its ends.
    pub fn cut(&mut self, leg: usize) -> [usize; 2] {
        self.is_cut[leg] = true;
        [self.ends[2 * leg], self.ends[2 * leg + 1]]
    }

    /// Visits every other pond that hangs together with `start`, with the dearest leg between them and its cost.
    pub fn walk(&mut self, start: usize, mut visit: impl FnMut(usize, usize, f64)) {
        // A pond, the leg it was reached by and the dearest leg on the way.
        self.stack.push((start, NONE, NONE));
        while let Some((pond, last, dearest)) = self.stack.pop() {
            if dearest != NONE {
                visit(pond, dearest, self.costs[dearest]);
            }
            let mut place = self.first_places[pond];
            while place != NONE {
                let leg = place / 2;
                if leg != last && !self.is_cut[leg] {
                    let is_dearer = dearest == NONE || self.costs[leg] > self.costs[dearest];
                    self.stack.push((self.ends[place ^ 1], leg, if is_dearer { leg } else { dearest }));
                }
                place = self.next_places[place];
            }
        }
    }
}
