//! Legs cut from several routes at once, and what the routes are once the pieces are joined in another way.
//!
//! Problem: a move takes some legs out of the plan and adds as many others. Whether that leaves routes that all go through a
//! depot, and what each then costs, must be known without making it.
//!
//! Method: the cuts are kept in their order along the routes; the cost of a piece between two of them is a difference of costs
//! up to its ends. A walk from depot to depot along pieces and added legs gives the cost of each new route; pieces that no walk
//! comes to would be on a ring without a depot. O(cuts), whatever the number of visits; what Helsgaun (European J. of
//! Operational Research 2000) does by tables of permutations for one tour.

/// Legs cut by one move, at most.
pub(super) const MAX_CUTS: usize = 5;
/// At least twice [`MAX_CUTS`], and a power of two: an index below that needs no check.
const MAX_ENDS: usize = 16;

/// A leg to be taken out, from the end that the move comes to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CutLeg {
    pub route: u32,
    /// Place of the leg on its route.
    pub position: u32,
    pub from: u32,
    pub to: u32,
    /// Whether `from` comes first on the route.
    pub is_forth: bool,
    /// Cost of the route up to the leg, and with it.
    pub head: f64,
    pub head_and_leg: f64,
    /// The leg added between the end of the cut before and `from`; for the first cut, the one that closes the move.
    pub added: f64,
}

impl CutLeg {
    fn key(&self) -> u64 {
        u64::from(self.route) << 32 | u64::from(self.position)
    }
}

/// Cuts in the order they were made.
#[derive(Clone, Debug, Default)]
pub(super) struct Move {
    pub cuts: [CutLeg; MAX_CUTS],
    pub num_cuts: usize,
    /// The cuts in their order along the routes.
    pub order: [u8; MAX_CUTS],
}

impl Move {
    pub fn has(&self, cut: &CutLeg) -> bool {
        self.cuts[..self.num_cuts].iter().any(|other| other.key() == cut.key())
    }

    pub fn push(&mut self, cut: CutLeg) {
        let mut at = self.num_cuts;
        while at > 0 && self.cuts[self.order[at - 1] as usize].key() > cut.key() {
            self.order[at] = self.order[at - 1];
            at -= 1;
        }
        self.order[at] = self.num_cuts as u8;
        self.cuts[self.num_cuts] = cut;
        self.num_cuts += 1;
    }

    pub fn pop(&mut self) {
        self.num_cuts -= 1;
        let last = self.num_cuts as u8;
        let mut kept = 0;
        for at in 0..=self.num_cuts {
            if self.order[at] != last {
                self.order[kept] = self.order[at];
                kept += 1;
            }
        }
    }

    /// Number of an end of a cut: a leg is added between the ends `2 i` and `2 i + 1`.
    fn ends(&self, cut: usize) -> [usize; 2] {
        [2 * cut + 1, if cut + 1 == self.num_cuts { 0 } else { 2 * cut + 2 }]
    }

    /// The cut that an end belongs to, and whether it is the end called `from`.
    fn cut_of(&self, end: usize) -> (&CutLeg, bool) {
        let index = (end + 2 * self.num_cuts - 1) % (2 * self.num_cuts);
        (&self.cuts[index / 2], index.is_multiple_of(2))
    }

    pub fn node(&self, end: usize) -> u32 {
        let (cut, is_from) = self.cut_of(end);
        if is_from { cut.from } else { cut.to }
    }

    /// Whether an end comes before its cut on the old route.
    pub fn is_before_cut(&self, end: usize) -> bool {
        let (cut, is_from) = self.cut_of(end);
        cut.is_forth == is_from
    }

    /// Walks along the new routes, and tells `piece` of every piece of an old one in turn: its two ends, which are the same if
    /// one is a depot, and whether it begins a route. Tells `done` what each route costs, until that says no. Returns whether
    /// all pieces are on routes through a depot.
    #[inline]
    pub fn walk(
        &self,
        costs: &[f64],
        mut piece: impl FnMut(usize, usize, bool),
        mut done: impl FnMut(f64) -> bool,
    ) -> bool {
        let pieces = Pieces::new(self, costs);
        let (mut is_done, mut num_added) = (0_u32, 0);
        for &start in &pieces.at_depots[..pieces.num_at_depots] {
            let mut end = start as usize;
            if is_done >> end & 1 == 1 {
                continue;
            }
            let mut cost = pieces.costs[end];
            piece(end, end, true);
            loop {
                let near = end ^ 1;
                let far = pieces.other_ends[near] as usize % MAX_ENDS;
                num_added += 1;
                cost += self.cuts[near / 2].added + pieces.costs[near];
                piece(near, far, false);
                if far == near {
                    is_done |= 1 << near;
                    break;
                }
                end = far;
            }
            if !done(cost) {
                return false;
            }
        }
        num_added == self.num_cuts
    }
}

/// What is left of the routes between the cuts, by the numbers of the ends.
#[derive(Default)]
struct Pieces {
    /// The other end of a piece; the same if that is a depot.
    other_ends: [u8; MAX_ENDS],
    costs: [f64; MAX_ENDS],
    at_depots: [u8; MAX_ENDS],
    num_at_depots: usize,
}

impl Pieces {
    #[inline]
    fn new(change: &Move, costs: &[f64]) -> Self {
        let mut pieces = Self::default();
        let mut before: Option<(&CutLeg, usize)> = None;
        for &index in &change.order[..change.num_cuts] {
            let cut = &change.cuts[index as usize];
            let [from, to] = change.ends(index as usize);
            let (first, second) = if cut.is_forth { (from, to) } else { (to, from) };
            match before {
                Some((other, end)) if other.route == cut.route => {
                    let cost = cut.head - other.head_and_leg;
                    (pieces.costs[end], pieces.costs[first]) = (cost, cost);
                    (pieces.other_ends[end], pieces.other_ends[first]) = (first as u8, end as u8);
                }
                _ => {
                    pieces.end_route(before, costs);
                    pieces.add_at_depot(first, cut.head);
                }
            }
            before = Some((cut, second));
        }
        pieces.end_route(before, costs);
        pieces
    }

    fn end_route(&mut self, last: Option<(&CutLeg, usize)>, costs: &[f64]) {
        if let Some((cut, end)) = last {
            self.add_at_depot(end, costs[cut.route as usize] - cut.head_and_leg);
        }
    }

    fn add_at_depot(&mut self, end: usize, cost: f64) {
        self.costs[end] = cost;
        self.other_ends[end] = end as u8;
        self.at_depots[self.num_at_depots] = end as u8;
        self.num_at_depots += 1;
    }
}
