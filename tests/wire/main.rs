//! Every answer that a standard numbers, provoked by datagrams: one row of a table a case.

mod abort_codes;
mod al_status_codes;
mod mailbox_errors;
mod transitions;
