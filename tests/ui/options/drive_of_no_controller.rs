use hexagen::Drive;

struct Hub;

fn main() {
    let drive = Drive::<Hub>::new();
}
