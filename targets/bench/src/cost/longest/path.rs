//! The longest path through a function and its callees.

use super::code::Code;
use super::flow::{ANY, Flags};
use super::loops::{Bound, bound, passes};
use super::measure::Measure;
use crate::BenchError;
use petgraph::Direction::Incoming;
use petgraph::algo::kosaraju_scc;
use petgraph::graphmap::DiGraphMap;
use std::collections::{BTreeMap, BTreeSet};

/// An instruction, and the flags that are possible in front of it.
type Node = (u32, Flags);

/// Length of a path; `None` where none returns.
type Longest = Option<u32>;

/// A call: the function, and the length of the memory block if that bounds the function's loops.
type Call = (u32, Option<u32>);

/// Searches longest paths, and remembers those of functions.
#[derive(Debug)]
pub struct Search<'a> {
    code: &'a Code<'a>,
    /// Part of the names of functions whose calls are left out with the paths through them.
    without: Option<&'static str>,
    measure: Measure,
    known: BTreeMap<Call, Longest>,
    /// Calls from the outermost to this.
    open: Vec<Call>,
}

/// What is reached from a function's entry without calls: where control goes from each instruction.
#[derive(Debug, Default)]
struct Body {
    /// With the length of each way from one instruction to another.
    graph: DiGraphMap<Node, u32>,
    /// Length of a node, that of a called function included.
    weights: BTreeMap<Node, u32>,
    /// Where a path ends: at a return, with the length of the way to the caller, or at a tail call,
    /// with that of what is called.
    returns: BTreeMap<Node, u32>,
}

impl<'a> Search<'a> {
    pub fn new(code: &'a Code<'a>, without: Option<&'static str>, measure: Measure) -> Self {
        Self {
            code,
            without,
            measure,
            known: BTreeMap::new(),
            open: vec![],
        }
    }

    /// The longest path from a function's call to its return, wherever the linker places the
    /// function and its callees.
    /// Paths that never return, as those of a panic, are no steps and are left out.
    ///
    /// # Errors
    /// If a jump is not followed, a loop has no bound, or a function calls itself.
    pub fn longest(&mut self, call: Call) -> Result<Longest, BenchError> {
        if let Some(&known) = self.known.get(&call) {
            return Ok(known);
        }
        if self.open.contains(&call) {
            return Err(self.error(
                call.0,
                "this function calls itself, so that no path is the longest",
            ));
        }
        self.open.push(call);
        let mut longest = None;
        for measure in self.measure.of_all_places() {
            let body = self.body(call.0, measure)?;
            let way = measure.of_jump(self.code, call.0);
            let placed = self.longest_of(&body, call)?;
            longest = longest.max(placed.map(|placed| placed + way));
        }
        self.open.pop();
        self.known.insert(call, longest);
        Ok(longest)
    }

    /// Follows control from a function's entry.
    fn body(&mut self, entry: u32, measure: Measure) -> Result<Body, BenchError> {
        let mut body = Body::default();
        let mut left = vec![(entry, ANY)];
        while let Some(node) = left.pop() {
            if body.weights.contains_key(&node) {
                continue;
            }
            let (at, flags) = node;
            let flow = self.code.flow(at).map_err(|text| self.error(at, &text))?;
            let called = match flow.calls {
                Some(function) => self.called(at, function)?,
                None => Some(0),
            };
            body.graph.add_node(node);
            let own = measure.of_instruction(self.code, at);
            body.weights.insert(node, own + called.unwrap_or(0));
            if called.is_none() {
                continue;
            }
            let (taken, else_flags) = match flow.condition {
                Some(condition) => (flags & condition, flags & !condition),
                None => (flags, flags),
            };
            if flow.returns && taken != 0 {
                body.returns.insert(node, measure.of_return());
            }
            let next = self.code.listing.after(at).filter(|_| flow.goes_on);
            let next = next.map(|next| {
                let way = measure.of_going_on(self.code, at, next, &flow);
                (next, else_flags, way)
            });
            let is_tail_call = |to: &u32| *to != entry && self.code.image.is_function(*to);
            let (tails, jumps): (Vec<u32>, Vec<u32>) =
                flow.jumps.iter().partition(|to| is_tail_call(to));
            for function in tails.into_iter().filter(|_| taken != 0) {
                if let Some(back) = self.called(at, function)? {
                    let known = body.returns.get(&node).copied();
                    body.returns.insert(node, back.max(known.unwrap_or(0)));
                }
            }
            let jumps = jumps
                .into_iter()
                .map(|to| (to, taken, measure.of_jump(self.code, to)));
            for (to, flags, way) in jumps.chain(next).filter(|&(_, flags, _)| flags != 0) {
                let successor = (to, if flow.keeps_flags { flags } else { ANY });
                let known = body.graph.edge_weight(node, successor);
                let way = way.max(known.copied().unwrap_or(0));
                body.graph.add_edge(node, successor, way);
                left.push(successor);
            }
        }
        Ok(body)
    }

    /// The longest path of a function that an instruction calls, or jumps to for good.
    fn called(&mut self, at: u32, function: u32) -> Result<Longest, BenchError> {
        let name = self.code.image.name_around(function);
        if self.without.is_some_and(|part| name.contains(part)) {
            return Ok(None);
        }
        let length = match bound(name) {
            Some(Bound::Length(argument)) => {
                let length = self.code.constant_argument(at, argument);
                // A library's function hands its own block on.
                let own = self.open.last().and_then(|&(_, length)| length);
                Some(length.or(own).ok_or_else(|| {
                    self.error(at, "the length of this memory block is no constant")
                })?)
            }
            _ => None,
        };
        self.longest((function, length))
    }

    /// The longest path through a function: components in the order from returns to the entry.
    fn longest_of(&self, body: &Body, call: Call) -> Result<Longest, BenchError> {
        let mut behind = BTreeMap::new();
        for component in kosaraju_scc(&body.graph) {
            let members: BTreeSet<Node> = component.into_iter().collect();
            let ends = |node: Node| body.end(node, &members, &behind);
            if !members.iter().any(|&node| ends(node).is_some()) {
                continue;
            }
            let first = members.first().copied().unwrap_or((call.0, ANY));
            let longest = if members.len() == 1 && !body.graph.contains_edge(first, first) {
                ends(first).map(|end| (first, end + body.weights[&first]))
            } else {
                Some(self.around(body, &members, ends, call)?)
            };
            behind.extend(longest);
        }
        Ok(behind.get(&(call.0, ANY)).copied())
    }

    /// The longest path from the only way into a loop: passes back to it, and one that leaves.
    fn around(
        &self,
        body: &Body,
        members: &BTreeSet<Node>,
        ends: impl Fn(Node) -> Longest,
        call: Call,
    ) -> Result<(Node, u32), BenchError> {
        let is_entered = |&node: &Node| {
            let mut from = body.graph.neighbors_directed(node, Incoming);
            node == (call.0, ANY) || from.any(|from| !members.contains(&from))
        };
        let mut heads = members.iter().copied().filter(is_entered);
        let (Some(head), None) = (heads.next(), heads.next()) else {
            let at = members.first().map_or(call.0, |&(at, _)| at);
            return Err(self.error(
                at,
                "this loop is entered at several places, which no bound covers",
            ));
        };
        let most = self.most_passes(head, members, call)?;
        let mut inner = DiGraphMap::<Node, u32>::new();
        for &node in members {
            inner.add_node(node);
            for (_, to, &way) in body.graph.edges(node) {
                if members.contains(&to) && to != head {
                    inner.add_edge(node, to, way);
                }
            }
        }
        let [mut leaving, mut returning] = [BTreeMap::new(), BTreeMap::new()];
        for component in kosaraju_scc(&inner) {
            let [node] = component[..] else {
                return Err(
                    self.error(head.0, "this loop has another in it, which no bound covers")
                );
            };
            let weight = body.weights[&node];
            let farthest = |known: &BTreeMap<Node, u32>, here: Longest| {
                let ways = inner.edges(node);
                let behind = ways.filter_map(|(_, to, way)| Some(known.get(&to)? + way));
                behind
                    .chain(here)
                    .max()
                    .map(|behind| (node, behind + weight))
            };
            let back = body.graph.edge_weight(node, head).copied();
            leaving.extend(farthest(&leaving, ends(node)));
            returning.extend(farthest(&returning, back));
        }
        let pass = returning.get(&head).copied().unwrap_or(0);
        let last = leaving.get(&head).copied().unwrap_or(0);
        Ok((head, most.saturating_sub(1) * pass + last))
    }

    /// How often each instruction of a loop is executed at most.
    fn most_passes(
        &self,
        head: Node,
        members: &BTreeSet<Node>,
        (_, length): Call,
    ) -> Result<u32, BenchError> {
        let writes_bytes = members.iter().any(|&(at, _)| {
            let line = self.code.listing.at(at);
            line.is_some_and(|line| line.mnemonic == "strb" || line.mnemonic == "sb")
        });
        match (bound(self.code.image.name_around(head.0)), length) {
            (Some(Bound::Passes(most)), _) => Ok(most),
            (Some(Bound::Length(_)), Some(length)) => Ok(passes(length, writes_bytes)),
            _ => Err(self.error(
                head.0,
                "this loop has no bound: emitted steps have no loops, and one of a library needs \
                 a bound with its reason in targets/bench/src/cost/longest/loops.rs",
            )),
        }
    }

    fn error(&self, at: u32, text: &str) -> BenchError {
        let function = self.code.image.name_around(at);
        BenchError::Failed(format!("longest path, `{function}` at {at:#x}: {text}"))
    }
}

impl Body {
    /// The longest path that leaves a component behind one of its nodes, that node not counted.
    fn end(&self, node: Node, members: &BTreeSet<Node>, behind: &BTreeMap<Node, u32>) -> Longest {
        let ways = self.graph.edges(node);
        let outside = ways.filter(|(_, to, _)| !members.contains(to));
        let returned = self.returns.get(&node).copied();
        let behind = outside.filter_map(|(_, to, way)| Some(behind.get(&to)? + way));
        behind.chain(returned).max()
    }
}
