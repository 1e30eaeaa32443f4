//! Sets what `hello` tells: the version of nalgebra in the lock file, the compiler's version and its flags.

fn main() {
    featherbench_interface::build::tell("nalgebra", "-C opt-level=3 -C codegen-units=1 -C lto=fat");
}
