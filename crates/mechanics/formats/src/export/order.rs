//! The order in which bodies and frames are written, so that reading the file gives their order back.

use featherbench_model::Description;

/// A body or a frame by its index.
#[derive(Clone, Copy)]
pub enum Item {
    Body(usize),
    Frame(usize),
}

/// The items on the world (first) and on each body: children in their order, and frames in theirs. A frame comes after a child whose branch
/// contains frames that precede it. So frames in depth-first order keep their order.
pub fn carried(robot: &Description) -> Vec<Vec<Item>> {
    let place = |parent: Option<usize>| parent.map_or(0, |body| body + 1);
    let mut first_frame = vec![usize::MAX; robot.bodies.len() + 1];
    for (k, frame) in robot.frames.iter().enumerate().rev() {
        first_frame[place(frame.body)] = k;
    }
    for (i, body) in robot.bodies.iter().enumerate().rev() {
        let parent = place(body.parent);
        first_frame[parent] = first_frame[parent].min(first_frame[i + 1]);
    }
    let mut frames = vec![Vec::new(); robot.bodies.len() + 1];
    for (k, frame) in robot.frames.iter().enumerate() {
        frames[place(frame.body)].push(k);
    }
    let mut frames: Vec<_> = frames.into_iter().map(|list| list.into_iter().peekable()).collect();
    let mut items = vec![Vec::new(); robot.bodies.len() + 1];
    for (i, body) in robot.bodies.iter().enumerate() {
        let parent = place(body.parent);
        let branch = Some(first_frame[i + 1]).filter(|&first| first != usize::MAX);
        while let Some(frame) = frames[parent].next_if(|frame| branch.is_some_and(|first| *frame < first)) {
            items[parent].push(Item::Frame(frame));
        }
        items[parent].push(Item::Body(i));
    }
    for (items, frames) in items.iter_mut().zip(frames) {
        items.extend(frames.map(Item::Frame));
    }
    items
}
