//! The raw link over a virtual cable.
#[cfg(target_os = "linux")]
#[path = "namespace_case/mod.rs"]
mod namespace_case;

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("the raw link works only on Linux: nothing tested");
}

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    namespace_case::main(&[
        ("frames_pass_both_ways_unchanged", linux::frames_pass_both_ways_unchanged),
        ("frames_for_any_address_arrive", linux::frames_for_any_address_arrive),
        (
            "frames_of_other_protocols_do_not_arrive",
            linux::frames_of_other_protocols_do_not_arrive,
        ),
        (
            "a_frame_longer_than_the_buffer_is_lost_and_counted",
            linux::a_frame_longer_than_the_buffer_is_lost_and_counted,
        ),
        ("an_end_does_not_hear_itself", linux::an_end_does_not_hear_itself),
        (
            "a_missing_interface_lists_the_existing_ones",
            linux::a_missing_interface_lists_the_existing_ones,
        ),
        (
            "an_interface_that_is_down_names_the_command",
            linux::an_interface_that_is_down_names_the_command,
        ),
        (
            "a_second_drive_server_is_refused_but_a_master_is_not",
            linux::a_second_drive_server_is_refused_but_a_master_is_not,
        ),
        ("a_missing_privilege_is_told", linux::a_missing_privilege_is_told),
        (
            "a_link_that_goes_down_resumes_when_it_is_up_again",
            linux::a_link_that_goes_down_resumes_when_it_is_up_again,
        ),
        ("a_removed_interface_is_an_error", linux::a_removed_interface_is_an_error),
        (
            "an_end_without_partner_has_no_carrier_and_loses_frames",
            linux::an_end_without_partner_has_no_carrier_and_loses_frames,
        ),
        (
            "two_interfaces_are_kept_apart_and_one_without_partner_is_down",
            linux::two_interfaces_are_kept_apart_and_one_without_partner_is_down,
        ),
        ("waiting_costs_next_to_nothing", linux::waiting_costs_next_to_nothing),
    ])
}

#[cfg(target_os = "linux")]
mod linux {
    use super::namespace_case::{become_nobody, enter, skip};
    use esc::Side;
    use netlink_packet_core::{NLM_F_ACK, NLM_F_REQUEST, NetlinkMessage, NetlinkPayload};
    use netlink_packet_route::RouteNetlinkMessage;
    use netlink_packet_route::link::{LinkFlags, LinkMessage};
    use netlink_sys::{Socket, SocketAddr, protocols::NETLINK_ROUTE};
    use std::time::{Duration, Instant};
    use usr2556e::link::cards::Cards;
    use usr2556e::link::raw::{RawLink, RawPair, Role};
    use usr2556e::link::{Link, LinkError, MAX_FRAME, Received};
    use usr2556e::namespace::{DRIVE_INTERFACE, MASTER_INTERFACE, REDUNDANT_DRIVE_INTERFACE, REDUNDANT_MASTER_INTERFACE, close_ring};

    /// Long enough for any machine; waited out only where something is wrong.
    const PATIENCE: Duration = Duration::from_secs(10);

    /// Long enough for a frame that should not come to have come.
    const SILENCE: Duration = Duration::from_millis(50);

    const BROADCAST: [u8; 6] = [0xFF; 6];

    fn both_ends() -> (RawLink, RawLink) {
        enter();
        let drive = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).unwrap();
        let master = RawLink::open(MASTER_INTERFACE, Role::Master).unwrap();
        (drive, master)
    }

    fn frame(destination: [u8; 6], ethertype: u16, length: usize) -> Vec<u8> {
        let mut frame: Vec<u8> = (0..length).map(|i| (i % 251) as u8).collect();
        frame[..6].copy_from_slice(&destination);
        frame[12..14].copy_from_slice(&ethertype.to_be_bytes());
        frame
    }

    /// The next frame, past announcements.
    fn next(link: &mut RawLink, wait: Duration) -> Option<Vec<u8>> {
        let mut buffer = [0; MAX_FRAME];
        let deadline = Instant::now() + wait;
        loop {
            match link
                .receive(&mut buffer, deadline.saturating_duration_since(Instant::now()))
                .unwrap()
            {
                Received::Frame(length) => return Some(buffer[..length].to_vec()),
                Received::Soon => {}
                Received::Timeout => return None,
                other => panic!("{other:?}"),
            }
        }
    }

    /// What `ip link set INTERFACE up|down` and `ip link del INTERFACE` do.
    fn change(interface: &str, request: impl FnOnce(LinkMessage) -> RouteNetlinkMessage) {
        let mut link = LinkMessage::default();
        link.header.index = nix::net::if_::if_nametoindex(interface).unwrap();
        link.header.change_mask = LinkFlags::Up;
        let mut message = NetlinkMessage::from(request(link));
        message.header.flags = NLM_F_REQUEST | NLM_F_ACK;
        message.finalize();
        let mut bytes = vec![0; message.buffer_len()];
        message.serialize(&mut bytes);
        let mut socket = Socket::new(NETLINK_ROUTE).unwrap();
        socket.bind_auto().unwrap();
        socket.send_to(&bytes, &SocketAddr::new(0, 0), 0).unwrap();
        let (answer, _) = socket.recv_from_full().unwrap();
        match NetlinkMessage::<RouteNetlinkMessage>::deserialize(&answer).unwrap().payload {
            NetlinkPayload::Error(answer) => assert_eq!(answer.code, None, "{answer:?}"),
            other => panic!("{other:?}"),
        }
    }

    fn switch(interface: &str, flags: LinkFlags) {
        change(interface, |mut link| {
            link.header.flags = flags;
            RouteNetlinkMessage::SetLink(link)
        });
    }

    pub fn frames_pass_both_ways_unchanged() {
        let (mut drive, mut master) = both_ends();
        for length in [14, 60, 61, 1514] {
            let sent = frame(BROADCAST, 0x88A4, length);
            master.send(&sent).unwrap();
            assert_eq!(next(&mut drive, PATIENCE), Some(sent.clone()));
            drive.send(&sent).unwrap();
            assert_eq!(next(&mut master, PATIENCE), Some(sent));
        }
        assert_eq!((drive.lost(), master.lost()), (0, 0));
    }

    pub fn frames_for_any_address_arrive() {
        let (mut drive, mut master) = both_ends();
        for destination in [[0x01, 0x01, 0x05, 0x01, 0, 0], [0x02, 1, 2, 3, 4, 5], [0; 6]] {
            let sent = frame(destination, 0x88A4, 60);
            master.send(&sent).unwrap();
            assert_eq!(next(&mut drive, PATIENCE), Some(sent));
        }
    }

    pub fn frames_of_other_protocols_do_not_arrive() {
        let (mut drive, mut master) = both_ends();
        master.send(&frame(BROADCAST, 0x0800, 60)).unwrap();
        master.send(&frame(BROADCAST, 0x88A5, 60)).unwrap();
        let sent = frame(BROADCAST, 0x88A4, 60);
        master.send(&sent).unwrap();
        assert_eq!(next(&mut drive, PATIENCE), Some(sent));
    }

    pub fn a_frame_longer_than_the_buffer_is_lost_and_counted() {
        let (mut drive, mut master) = both_ends();
        master.send(&frame(BROADCAST, 0x88A4, 100)).unwrap();
        master.send(&frame(BROADCAST, 0x88A4, 64)).unwrap();
        assert_eq!(drive.receive(&mut [0; 64], PATIENCE).unwrap(), Received::Frame(64));
        assert_eq!(drive.lost(), 1);
    }

    pub fn an_end_does_not_hear_itself() {
        let (mut drive, _master) = both_ends();
        drive.send(&frame(BROADCAST, 0x88A4, 60)).unwrap();
        assert_eq!(next(&mut drive, SILENCE), None);
    }

    pub fn a_missing_interface_lists_the_existing_ones() {
        enter();
        let text = RawLink::open("eth-no-such", Role::Master).unwrap_err().to_string();
        let first = text.lines().next().unwrap();
        assert!(first.starts_with("there is no network interface \"eth-no-such\""), "{text}");
        assert!(
            ["lo", DRIVE_INTERFACE, MASTER_INTERFACE].iter().all(|name| first.contains(name)),
            "{text}"
        );
        assert!(RawLink::open("a-name-longer-than-an-interface-may-have", Role::Master).is_err());
        assert!(RawLink::open("", Role::Master).is_err());
        assert!(RawLink::open("nul\0inside", Role::Master).is_err());
    }

    pub fn an_interface_that_is_down_names_the_command() {
        enter();
        switch(DRIVE_INTERFACE, LinkFlags::empty());
        let text = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).unwrap_err().to_string();
        assert!(
            text.contains("is down") && text.contains("\n  sudo ip link set usr2556e0 up"),
            "{text}"
        );
    }

    pub fn a_second_drive_server_is_refused_but_a_master_is_not() {
        let (drive, _master) = both_ends();
        let text = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).unwrap_err().to_string();
        let pid = std::process::id();
        assert!(
            text.contains(&format!("(process {pid})")) && text.contains(&format!("\n  kill {pid}\n")),
            "{text}"
        );
        assert!(RawLink::open(DRIVE_INTERFACE, Role::Master).is_ok());
        assert!(RawLink::open(MASTER_INTERFACE, Role::DriveServer).is_ok());
        drop(drive);
        assert!(RawLink::open(DRIVE_INTERFACE, Role::DriveServer).is_ok());
    }

    pub fn a_missing_privilege_is_told() {
        if nix::unistd::geteuid().is_root() {
            enter();
        }
        become_nobody();
        if nix::unistd::geteuid().is_root() {
            skip("root cannot give its rights up here");
        }
        let text = match RawLink::open("lo", Role::Master) {
            Ok(_) => skip("this user may use raw Ethernet"),
            Err(usr2556e::link::open_error::OpenError::Down { .. }) => skip("lo is down"),
            Err(error) => error.to_string(),
        };
        assert!(text.starts_with("no permission"), "{text}");
        assert!(
            text.contains("sudo setcap cap_net_raw+ep") && text.contains("exec --drives 1 -- COMMAND"),
            "{text}"
        );
    }

    pub fn a_link_that_goes_down_resumes_when_it_is_up_again() {
        let (mut drive, mut master) = both_ends();
        let mut buffer = [0; MAX_FRAME];
        switch(DRIVE_INTERFACE, LinkFlags::empty());
        assert_eq!(drive.receive(&mut buffer, PATIENCE).unwrap(), Received::Down);
        assert_eq!(drive.receive(&mut buffer, SILENCE).unwrap(), Received::Timeout);
        drive.send(&frame(BROADCAST, 0x88A4, 60)).unwrap();
        assert_eq!(drive.lost(), 1);

        switch(DRIVE_INTERFACE, LinkFlags::Up);
        assert_eq!(drive.receive(&mut buffer, PATIENCE).unwrap(), Received::Up);
        let sent = frame(BROADCAST, 0x88A4, 60);
        master.send(&sent).unwrap();
        assert_eq!(next(&mut drive, PATIENCE), Some(sent));
    }

    pub fn a_removed_interface_is_an_error() {
        let (mut drive, mut master) = both_ends();
        let mut buffer = [0; MAX_FRAME];
        change(DRIVE_INTERFACE, RouteNetlinkMessage::DelLink);
        for link in [&mut drive, &mut master] {
            // Lost, not an error: sending finds a wire without an end.
            let _ = link.send(&frame(BROADCAST, 0x88A4, 60));
            for _ in 0..2 {
                let error = link.receive(&mut buffer, PATIENCE).unwrap_err();
                assert!(matches!(error, LinkError::Removed { .. }), "{error}");
            }
        }
        assert!(!drive.carrier());
    }

    pub fn an_end_without_partner_has_no_carrier_and_loses_frames() {
        let (mut drive, _master) = both_ends();
        assert!(drive.carrier());
        switch(MASTER_INTERFACE, LinkFlags::empty());
        let deadline = Instant::now() + PATIENCE;
        while drive.carrier() {
            assert!(Instant::now() < deadline);
            std::thread::sleep(Duration::from_millis(10));
        }
        drive.send(&frame(BROADCAST, 0x88A4, 60)).unwrap();
        assert_eq!(drive.lost(), 1);
        assert_eq!(next(&mut drive, SILENCE), None);
    }

    /// What a pair receives next, other than time-outs and announcements.
    fn next_of_pair(pair: &mut RawPair) -> (Side, Received) {
        let deadline = Instant::now() + PATIENCE;
        loop {
            assert!(Instant::now() < deadline);
            match pair.receive_any(&mut [0; MAX_FRAME], SILENCE).unwrap() {
                (_, Received::Timeout | Received::Soon) => {}
                received => return received,
            }
        }
    }

    pub fn two_interfaces_are_kept_apart_and_one_without_partner_is_down() {
        enter();
        close_ring().unwrap();
        let mut pair = RawPair::open([DRIVE_INTERFACE, REDUNDANT_DRIVE_INTERFACE]).unwrap();
        let names = [MASTER_INTERFACE, REDUNDANT_MASTER_INTERFACE];
        let mut masters = names.map(|interface| RawLink::open(interface, Role::Master).unwrap());
        for (side, length) in [(Side::Primary, 60), (Side::Secondary, 61), (Side::Secondary, 62)] {
            let sent = frame(BROADCAST, 0x88A4, length);
            masters[side as usize].send(&sent).unwrap();
            assert_eq!(next_of_pair(&mut pair), (side, Received::Frame(length)));
            pair.send_to(side, &sent).unwrap();
            assert_eq!(next(&mut masters[side as usize], PATIENCE), Some(sent));
            assert_eq!(next(&mut masters[1 - side as usize], Duration::ZERO), None);
        }
        switch(REDUNDANT_MASTER_INTERFACE, LinkFlags::empty());
        assert_eq!(next_of_pair(&mut pair), (Side::Secondary, Received::Down));
        masters[0].send(&frame(BROADCAST, 0x88A4, 60)).unwrap();
        assert_eq!(
            next_of_pair(&mut pair),
            (Side::Primary, Received::Frame(60)),
            "the other one goes on"
        );
        switch(REDUNDANT_MASTER_INTERFACE, LinkFlags::Up);
        assert_eq!(next_of_pair(&mut pair), (Side::Secondary, Received::Up));
        switch(DRIVE_INTERFACE, LinkFlags::empty());
        assert_eq!(next_of_pair(&mut pair), (Side::Primary, Received::Down));
        switch(DRIVE_INTERFACE, LinkFlags::Up);
        assert_eq!(next_of_pair(&mut pair), (Side::Primary, Received::Up));
    }

    /// Nanoseconds of processor time that this thread has used.
    fn processor_time() -> u64 {
        let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        statistics.split(' ').next().and_then(|field| field.parse().ok()).unwrap_or(0)
    }

    /// Only prints: the figures depend on the machine and on what else it does.
    pub fn waiting_costs_next_to_nothing() {
        let (mut drive, mut master) = both_ends();
        let mut buffer = [0; MAX_FRAME];
        let measure = |what: &str, drive: &mut RawLink, buffer: &mut [u8]| {
            let (started, before) = (Instant::now(), processor_time());
            let (mut frames, mut announced) = (0, 0);
            while started.elapsed() < Duration::from_millis(500) {
                match drive.receive(buffer, Duration::from_millis(10)).unwrap() {
                    Received::Frame(_) => frames += 1,
                    Received::Soon => announced += 1,
                    _ => {}
                }
            }
            let share = (processor_time() - before) as f64 / started.elapsed().as_nanos() as f64;
            println!(
                "measured: {what}: {:.1} % of a core, {frames} frames, {announced} announced",
                100.0 * share
            );
        };
        measure("idle", &mut drive, &mut buffer);
        let sender = std::thread::spawn(move || {
            let mut due = Instant::now();
            for _ in 0..500 {
                due += Duration::from_millis(1);
                std::thread::sleep(due.saturating_duration_since(Instant::now()));
                master.send(&frame(BROADCAST, 0x88A4, 60)).unwrap();
            }
        });
        measure("1 kHz", &mut drive, &mut buffer);
        sender.join().unwrap();
        measure("idle afterwards", &mut drive, &mut buffer);
    }
}
