//! Receive times, and the propagation delays that masters compute from them: those of the segment's model, to the nanosecond.

mod bus;

use bus::{Bus, SECONDARY, STATION, junction, port};
use esc::segment::{PROCESSING_DELAY_NS, WIRE_DELAY_NS};
use proptest::prelude::*;
use wire::frame::{Command, physical_address};
use wire::register::*;

const HOP: u32 = (PROCESSING_DELAY_NS + WIRE_DELAY_NS) as u32;

/// The order in which a frame passes the ports.
const ORDER: [usize; 4] = [0, 3, 1, 2];

/// Which chip hangs at which port of which: parent and port, for all but the first. Children come behind their parents.
#[derive(Clone, Debug)]
struct Tree(Vec<(usize, usize)>);

impl Tree {
    fn line(count: usize) -> Self {
        Self((1..count).map(|position| (position - 1, 1)).collect())
    }

    /// What hangs at a port.
    fn child(&self, parent: usize, port: usize) -> Option<usize> {
        self.0.iter().position(|link| *link == (parent, port)).map(|at| at + 1)
    }

    fn bus(&self) -> Bus {
        let chips = (0..=self.0.len() as u64).map(|at| junction(1_000_000 + 777_777 * at, 4));
        let mut bus = Bus::of(chips.collect());
        for position in 0..self.0.len() {
            bus.unplug(port(position, 1));
        }
        for (at, (parent, out)) in self.0.iter().enumerate() {
            bus.plug(port(*parent, *out), port(at + 1, 0));
        }
        bus
    }

    /// The model: chips in the order in which a frame reaches them, with the time it takes; `at` is when it reaches `chip`. Returns
    /// when it comes back to the port that leads there.
    fn walk(&self, chip: usize, at: u32, reached: &mut Vec<(usize, u32)>) -> u32 {
        reached.push((chip, at));
        let mut time = at + HOP;
        for out in [3, 1, 2] {
            if let Some(child) = self.child(chip, out) {
                time = self.walk(child, time, reached) + HOP;
            }
        }
        time
    }

    fn expected(&self) -> Vec<(usize, u32)> {
        let mut reached = Vec::new();
        self.walk(0, 0, &mut reached);
        reached
    }
}

/// What a master knows of one slave.
#[derive(Clone, Debug)]
struct Slave {
    times: [u32; 4],
    active: [bool; 4],
    processing: u64,
}

impl Slave {
    fn active_count(&self) -> usize {
        self.active.iter().filter(|active| **active).count()
    }

    fn entry(&self) -> usize {
        let active = ORDER.into_iter().filter(|port| self.active[*port]);
        active
            .min_by_key(|port| self.times[*port].wrapping_sub(self.times[0]) as i32)
            .unwrap()
    }
}

/// Latches and reads as every master does, in the order of positions.
fn latch(bus: &mut Bus) -> Vec<Slave> {
    let count = bus.one(Command::Bwr, physical_address(0, DC_RECEIVE_TIMES), &[0; 4]).wkc;
    (0..count)
        .map(|position| {
            let mut read = |ado, length| {
                bus.one(Command::Aprd, physical_address(0u16.wrapping_sub(position), ado), &vec![0; length])
                    .data
            };
            let times = read(DC_RECEIVE_TIMES, 16);
            let status = u16::from_le_bytes(read(DL_STATUS, 2).try_into().unwrap());
            Slave {
                times: std::array::from_fn(|port| u32::from_le_bytes(times[4 * port..][..4].try_into().unwrap())),
                active: std::array::from_fn(|port| status >> (8 + 2 * port) & 3 == 2),
                processing: u64::from_le_bytes(read(DC_PROCESSING_TIME, 8).try_into().unwrap()),
            }
        })
        .collect()
}

/// SOEM and KickCAT (ec_config.c, ec_dc.c): parents from the number of active ports, delays from the parent's port times.
fn soem(slaves: &[Slave]) -> Vec<u32> {
    let mut parents = vec![None; slaves.len()];
    for (slave, parent) in parents.iter_mut().enumerate().skip(1) {
        let mut open = 0;
        for candidate in (0..slave).rev() {
            let topology = slaves[candidate].active_count() as i32;
            open += match topology {
                1 => -1,
                3 => 1,
                4 => 2,
                _ => 0,
            };
            if open >= 0 && topology > 1 || candidate == 0 {
                *parent = Some(candidate);
                break;
            }
        }
    }
    let previous = |slave: &Slave, port: usize| {
        let before: &[usize] = match port {
            0 => &[2, 1, 3],
            1 => &[3, 0, 2],
            2 => &[1, 3, 0],
            _ => &[0, 2, 1],
        };
        before.iter().copied().find(|port| slave.active[*port]).unwrap_or(port)
    };
    let time = |slave: &Slave, port: usize| slave.times[port] as i32;
    let mut free: Vec<[bool; 4]> = slaves.iter().map(|slave| slave.active).collect();
    let mut delays = vec![0; slaves.len()];
    for (index, slave) in slaves.iter().enumerate() {
        let entry = slave.entry();
        free[index][entry] = false;
        let Some(above) = parents[index] else { continue };
        let parent = &slaves[above];
        let mut parent_port = [3, 1, 2, 0].into_iter().find(|port| free[above][*port]).unwrap();
        free[above][parent_port] = false;
        if parent.active_count() == 1 {
            parent_port = parent.entry();
        }
        let before = previous(parent, parent_port);
        let around = time(parent, parent_port) - time(parent, before);
        let own = if slave.active_count() > 1 {
            time(slave, previous(slave, entry)) - time(slave, entry)
        } else {
            0
        };
        let own = if own > around { -own } else { own };
        let others = if index - above > 1 {
            (time(parent, before) - time(parent, parent.entry())).abs()
        } else {
            0
        };
        delays[index] = ((around - own) / 2 + others) as u32 + delays[above];
    }
    delays
}

/// IgH EtherLab (master.c, slave.c): the tree by recursion in the order of ports, each link's delay from the round trips at its ends.
fn igh(slaves: &[Slave]) -> Vec<u32> {
    fn after(port: usize) -> usize {
        [3, 2, 0, 1][port]
    }
    struct Node {
        upstream: usize,
        next: [Option<usize>; 4],
    }
    fn topology(slaves: &[Slave], at: &mut usize, nodes: &mut Vec<Node>) {
        let own = *at;
        let upstream = slaves[own].entry();
        nodes.push(Node { upstream, next: [None; 4] });
        let mut port = after(upstream);
        while port != upstream {
            if slaves[own].active[port] && *at + 1 < slaves.len() {
                *at += 1;
                nodes[own].next[port] = Some(*at);
                topology(slaves, at, nodes);
            }
            port = after(port);
        }
    }
    /// Ports with a slave behind them, in the order after the upstream port, each with the port before it.
    fn downstream(node: &Node) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        let (mut before, mut port) = (node.upstream, after(node.upstream));
        while port != node.upstream {
            if node.next[port].is_some() {
                pairs.push((before, port));
                before = port;
            }
            port = after(port);
        }
        pairs
    }
    fn round_trip(slave: &Slave, node: &Node) -> u32 {
        downstream(node)
            .iter()
            .map(|(before, port)| slave.times[*port].wrapping_sub(slave.times[*before]))
            .sum()
    }
    fn delays(slaves: &[Slave], nodes: &[Node], at: usize, delay: &mut u32, all: &mut [u32]) {
        all[at] = *delay;
        for (before, port) in downstream(&nodes[at]) {
            let next = nodes[at].next[port].unwrap();
            let trip = slaves[at].times[port].wrapping_sub(slaves[at].times[before]);
            let link = (trip - round_trip(&slaves[next], &nodes[next])) / 2;
            *delay += link;
            delays(slaves, nodes, next, delay, all);
            *delay += link;
        }
    }
    let mut nodes = Vec::new();
    topology(slaves, &mut 0, &mut nodes);
    let mut all = vec![0; slaves.len()];
    delays(slaves, &nodes, 0, &mut 0, &mut all);
    all
}

/// ethercrab (dc.rs, ports.rs): parents from the nearest junction, delays added up from slave to slave. For junctions of three ports.
fn ethercrab(slaves: &[Slave]) -> Vec<u32> {
    let total = |slave: &Slave| {
        let times = ORDER.into_iter().filter(|port| slave.active[*port]).map(|port| slave.times[port]);
        times.clone().max().unwrap() - times.min().unwrap()
    };
    let mut assigned = vec![[false; 4]; slaves.len()];
    let mut delays = vec![0; slaves.len()];
    let mut sum = 0;
    for index in 1..slaves.len() {
        let above = if slaves[index - 1].active_count() == 1 {
            (0..index).rev().find(|at| slaves[*at].active_count() > 2).unwrap_or(0)
        } else {
            index - 1
        };
        let parent = &slaves[above];
        let out = [3, 1, 2]
            .into_iter()
            .find(|port| parent.active[*port] && !assigned[above][*port])
            .unwrap();
        assigned[above][out] = true;
        let last = [2, 1, 3].into_iter().find(|port| parent.active[*port]);
        let is_child = parent.active_count() > 2 && last != Some(out);
        let own = total(&slaves[index]);
        sum += match parent.active_count() {
            3 if is_child => (parent.times[out] - parent.times[parent.entry()] - own) / 2,
            2 | 3 => (total(parent) - own) / 2,
            _ => 0,
        };
        delays[index] = sum;
    }
    delays
}

/// The model's delays in the order of positions; asserts that addressing counts in that order.
fn model(tree: &Tree, bus: &mut Bus) -> Vec<u32> {
    let reached = tree.expected();
    for (position, (chip, _)) in reached.iter().enumerate() {
        let address = physical_address(0u16.wrapping_sub(position as u16), STATION_ADDRESS);
        let answer = bus.one(Command::Aprd, address, &[0; 2]);
        assert_eq!(
            answer.data,
            (STATION + *chip as u16).to_le_bytes(),
            "position {position} of {tree:?}"
        );
    }
    reached.into_iter().map(|(_, delay)| delay).collect()
}

#[test]
fn every_master_finds_the_delays_of_a_line() {
    for count in 1..=9 {
        let tree = Tree::line(count);
        let mut bus = tree.bus();
        let expected = model(&tree, &mut bus);
        assert_eq!(expected, (0..count as u32).map(|position| position * HOP).collect::<Vec<_>>());
        let slaves = latch(&mut bus);
        assert_eq!(soem(&slaves), expected);
        assert_eq!(igh(&slaves), expected);
        assert_eq!(ethercrab(&slaves), expected);
    }
}

#[test]
fn receive_times_are_those_of_the_latching_frame_at_each_port() {
    let tree = Tree(vec![(0, 1), (1, 3), (1, 1), (0, 2)]);
    let mut bus = tree.bus();
    for now in [5_000_000, 9_000_000] {
        bus.now = now;
        let slaves = latch(&mut bus);
        let local = |chip: u32, hops: u32| 1_000_000 + 777_777 * chip + now as u32 + hops * HOP;
        assert_eq!(slaves[0].times, [local(0, 0), local(0, 6), local(0, 8), 0]);
        assert_eq!(slaves[1].times, [local(1, 1), local(1, 5), 0, local(1, 3)]);
        assert_eq!(slaves[2].times, [local(2, 2), 0, 0, 0]);
        assert_eq!(slaves[3].times, [local(3, 4), 0, 0, 0]);
        assert_eq!(slaves[4].times, [local(4, 7), 0, 0, 0]);
        for slave in slaves {
            assert_eq!(slave.processing, u64::from(slave.times[0]));
        }
        // A frame that does not latch leaves them.
        bus.now += 100;
        bus.one(Command::Brd, 0, &[0]);
    }
}

#[test]
fn soem_and_igh_find_the_delays_of_branches() {
    let trees = [
        vec![(0, 1), (0, 2)],
        vec![(0, 3), (0, 1)],
        vec![(0, 3), (0, 1), (0, 2)],
        vec![(0, 1), (1, 1), (2, 1), (1, 2), (4, 1), (5, 1)],
        vec![(0, 3), (1, 1), (2, 3), (3, 1), (0, 1), (5, 2), (0, 2), (7, 1)],
    ];
    for links in trees {
        let tree = Tree(links);
        let mut bus = tree.bus();
        let expected = model(&tree, &mut bus);
        let slaves = latch(&mut bus);
        assert_eq!(soem(&slaves), expected, "{tree:?}");
        assert_eq!(igh(&slaves), expected, "{tree:?}");
    }
}

#[test]
fn every_master_finds_the_delays_of_what_is_left_of_a_broken_ring() {
    for count in 2..=6 {
        for broken in 1..=count {
            let mut bus = Tree::line(count).bus();
            bus.plug(port(count - 1, 1), SECONDARY);
            bus.unplug(port(broken - 1, 1));
            let expected: Vec<u32> = (0..broken as u32).map(|position| position * HOP).collect();
            let slaves = latch(&mut bus);
            assert_eq!(slaves.len(), broken);
            assert_eq!(soem(&slaves), expected);
            assert_eq!(igh(&slaves), expected);
            assert_eq!(ethercrab(&slaves), expected);
        }
    }
}

/// Trees of up to eleven chips, numbered as they are found.
fn tree() -> impl Strategy<Value = Tree> {
    prop::collection::vec((any::<prop::sample::Index>(), 1..4usize), 0..10).prop_map(|links| {
        let mut tree = Tree(Vec::new());
        for (parent, port) in links {
            let parent = parent.index(tree.0.len() + 1);
            if tree.child(parent, port).is_none() {
                tree.0.push((parent, port));
            }
        }
        tree
    })
}

/// A line whose chips may have a side branch, itself a line: what ethercrab finds its way through.
fn comb() -> impl Strategy<Value = Tree> {
    prop::collection::vec((0..4usize, any::<bool>()), 1..5).prop_map(|line| {
        let mut links = Vec::new();
        let mut above = None;
        for (teeth, early) in line {
            links.extend(above);
            let own = links.len();
            for tooth in 0..teeth {
                let side = if early { 3 } else { 1 };
                links.push(if tooth == 0 { (own, side) } else { (links.len(), 1) });
            }
            above = Some((own, if early { 1 } else { 2 }));
        }
        Tree(links)
    })
}

proptest! {
    #[test]
    fn every_master_finds_the_delays_of_side_branches(tree in comb()) {
        let mut bus = tree.bus();
        let expected = model(&tree, &mut bus);
        let slaves = latch(&mut bus);
        prop_assert_eq!(ethercrab(&slaves), expected.clone());
        prop_assert_eq!(soem(&slaves), expected.clone());
        prop_assert_eq!(igh(&slaves), expected);
    }

    #[test]
    fn soem_and_igh_find_the_delays_of_any_tree(tree in tree()) {
        let mut bus = tree.bus();
        let expected = model(&tree, &mut bus);
        let slaves = latch(&mut bus);
        prop_assert_eq!(soem(&slaves), expected.clone());
        prop_assert_eq!(igh(&slaves), expected);
    }
}
