//! No call on a workspace allocates, after the first of each.

#![allow(unsafe_code, reason = "a counting allocator has to implement the unsafe trait GlobalAlloc")]

use crate::common::every_joint;
use featherbench_rbd::spatial::Force;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that is being torn down has no counter.
        let _ = ALLOCATIONS.try_with(|allocations| allocations.set(allocations.get() + 1));
        // SAFETY: the caller's promise about `layout` is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise about `pointer` and `layout` is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_workspace_allocates_in_its_first_calls_only() {
    let robot = every_joint(true);
    let (q, v) = (robot.random(1), vec![0.1; robot.nv()]);
    let (mut out, mut next) = (v.clone(), q.clone());
    let wrenches = vec![Force::from_array([1.0; 6]); robot.bodies().len()];
    let wrenches = Some(wrenches.as_slice());
    let (tool, mut workspace) = (robot.frame("tool").unwrap(), robot.workspace());
    let mut counts = Vec::new();
    for _ in 0..3 {
        let before = ALLOCATIONS.with(Cell::get);
        workspace.inverse_dynamics(&q, &v, &v, wrenches, &mut out).unwrap();
        workspace.bias_force(&q, &v, None, &mut out).unwrap();
        workspace.forward_dynamics(&q, &v, &v, wrenches, &mut out).unwrap();
        workspace.mass_matrix(&q).unwrap();
        workspace.solve(&q, &mut out).unwrap();
        workspace.placements(&q).unwrap().placement(&tool).unwrap();
        workspace.kinematics(&q, &v, &v).unwrap().motion(&tool).unwrap();
        workspace.jacobian(&q, &tool).unwrap();
        workspace.inverse_dynamics_derivatives(&q, &v, &v, wrenches).unwrap();
        workspace.forward_dynamics_derivatives(&q, &v, &v, wrenches).unwrap();
        robot.integrate_into(&q, &v, &mut next).unwrap();
        robot.difference_into(&q, &next, &mut out).unwrap();
        counts.push(ALLOCATIONS.with(Cell::get) - before);
    }
    assert!(counts[0] > 0, "the allocator counts");
    assert_eq!(counts[1..], [0, 0]);
}
