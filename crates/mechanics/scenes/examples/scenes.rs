//! Prints every scene as JSON, one a line: what an oracle gets.

fn main() -> Result<(), serde_json::Error> {
    for question in featherbench_scenes::systems::all() {
        println!("{}", serde_json::json!({"scene": serde_json::to_value(&question.scene)?, "duration": question.duration}));
    }
    Ok(())
}
