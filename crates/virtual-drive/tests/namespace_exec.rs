//! What `usr2556e exec` is made of: a network of its own, and a command whose end is passed on.
#[cfg(target_os = "linux")]
#[path = "namespace_case/mod.rs"]
mod namespace_case;

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("namespaces work only on Linux: nothing tested");
}

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    namespace_case::main(&[
        (
            "the_namespace_holds_a_cable_and_nothing_else",
            linux::the_namespace_holds_a_cable_and_nothing_else,
        ),
        ("a_user_without_rights_gets_one_too", linux::a_user_without_rights_gets_one_too),
        (
            "it_is_too_late_once_there_are_threads",
            linux::it_is_too_late_once_there_are_threads,
        ),
        (
            "the_command_finds_its_interface_in_the_environment",
            linux::the_command_finds_its_interface_in_the_environment,
        ),
        ("the_exit_code_is_passed_on", linux::the_exit_code_is_passed_on),
        (
            "a_signal_that_ends_the_command_is_128_and_its_number",
            linux::a_signal_that_ends_the_command_is_128_and_its_number,
        ),
        ("a_missing_command_is_127", linux::a_missing_command_is_127),
        ("a_file_that_is_not_executable_is_126", linux::a_file_that_is_not_executable_is_126),
        ("ctrl_c_is_left_to_the_command", linux::ctrl_c_is_left_to_the_command),
        ("sigterm_is_handed_to_the_command", linux::sigterm_is_handed_to_the_command),
        (
            "the_command_starts_with_default_signals",
            linux::the_command_starts_with_default_signals,
        ),
    ])
}

#[cfg(target_os = "linux")]
mod linux {
    use super::namespace_case::{become_nobody, enter};
    use std::ffi::{OsStr, OsString};
    use usr2556e::link::raw::{RawLink, Role};
    use usr2556e::link::{Link, Received};
    use usr2556e::namespace::command::{CommandError, run};
    use usr2556e::namespace::{DRIVE_INTERFACE, EnterError, INTERFACE_VARIABLE, MASTER_INTERFACE};

    fn shell(script: &str) -> Result<u8, CommandError> {
        run(
            &["sh", "-c", script].map(OsString::from),
            &[(INTERFACE_VARIABLE, OsStr::new(MASTER_INTERFACE))],
        )
    }

    fn check_cable() {
        let mut names: Vec<_> = nix::net::if_::if_nameindex()
            .unwrap()
            .iter()
            .map(|i| i.name().to_str().unwrap().to_string())
            .collect();
        // Tunnel interfaces that some kernels put into every new namespace.
        names.retain(|name| name == "lo" || name.starts_with("usr2556e"));
        names.sort();
        assert_eq!(names, ["lo", DRIVE_INTERFACE, MASTER_INTERFACE]);
        let mut drive = RawLink::open(DRIVE_INTERFACE, Role::DriveServer).unwrap();
        let mut master = RawLink::open(MASTER_INTERFACE, Role::Master).unwrap();
        let mut frame = [0xFF; 60];
        frame[12..14].copy_from_slice(&[0x88, 0xA4]);
        master.send(&frame).unwrap();
        assert_eq!(
            drive.receive(&mut [0; 64], std::time::Duration::from_secs(10)).unwrap(),
            Received::Frame(60)
        );
        assert!(nix::unistd::geteuid().is_root());
    }

    pub fn the_namespace_holds_a_cable_and_nothing_else() {
        enter();
        check_cable();
    }

    pub fn a_user_without_rights_gets_one_too() {
        become_nobody();
        enter();
        check_cable();
        // And the command sees the same network.
        assert_eq!(shell("grep -q usr2556e1 /proc/net/dev").unwrap(), 0);
    }

    pub fn it_is_too_late_once_there_are_threads() {
        let (end, wait) = std::sync::mpsc::channel::<()>();
        let thread = std::thread::spawn(move || wait.recv());
        assert!(matches!(usr2556e::namespace::enter(), Err(EnterError::Threads)));
        drop(end);
        let _ = thread.join();
    }

    pub fn the_command_finds_its_interface_in_the_environment() {
        assert_eq!(shell(r#"test "$USR2556E_INTERFACE" = usr2556e1"#).unwrap(), 0);
    }

    pub fn the_exit_code_is_passed_on() {
        for code in [0, 1, 7, 255] {
            assert_eq!(shell(&format!("exit {code}")).unwrap(), code);
        }
    }

    pub fn a_signal_that_ends_the_command_is_128_and_its_number() {
        assert_eq!(shell("kill -KILL $$").unwrap(), 128 + 9);
    }

    pub fn a_missing_command_is_127() {
        let error = run(&["usr2556e-no-such-command".into()], &[]).unwrap_err();
        assert_eq!(error.exit_code(), 127);
        assert_eq!(error.to_string(), "command not found: usr2556e-no-such-command");
    }

    pub fn a_file_that_is_not_executable_is_126() {
        let file = std::env::temp_dir().join(format!("usr2556e-not-executable-{}", std::process::id()));
        std::fs::write(&file, "#!/bin/sh\n").unwrap();
        let error = run(&[file.clone().into()], &[]).unwrap_err();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(error.exit_code(), 126);
        assert!(error.to_string().contains("chmod +x"), "{error}");
    }

    pub fn ctrl_c_is_left_to_the_command() {
        assert_eq!(shell("kill -INT $PPID; kill -QUIT $PPID; sleep 0.1; exit 5").unwrap(), 5);
    }

    pub fn sigterm_is_handed_to_the_command() {
        assert_eq!(
            shell("trap 'exit 9' TERM; kill -TERM $PPID; for i in 1 2 3 4 5 6 7 8 9 10; do sleep 1; done").unwrap(),
            9
        );
    }

    pub fn the_command_starts_with_default_signals() {
        // Neither ignored nor blocked: SIGHUP, SIGINT, SIGQUIT, SIGTERM.
        let script = r"while read name mask; do case $name in SigBlk:|SigIgn:) test $((0x$mask & 0x4007)) = 0 || exit 1;; esac; done < /proc/self/status";
        assert_eq!(shell(script).unwrap(), 0);
    }
}
