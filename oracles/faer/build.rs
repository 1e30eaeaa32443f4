//! Sets what `hello` tells: the version of faer in the lock file, the compiler's version and its flags.

fn main() {
    featherbench_interface::build::tell("faer", "-C opt-level=3 -C codegen-units=1 -C lto=fat");
}
