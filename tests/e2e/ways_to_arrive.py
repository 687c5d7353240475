"""The ways in which files come into a watched folder, well-behaved and not. Each takes the folder, the file's name and
its text, and returns how many jobs must come of it: 1, 0, or None where both are right (it was gone before it was whole)."""
import mmap
import os
import subprocess
import time


def renamed(folder, name, text):
    (folder / f".{name}").write_text(text)
    (folder / f".{name}").rename(folder / name)
    return 1


def part_then_renamed(folder, name, text):
    (folder / f"{name}.part").write_text(text)
    (folder / f"{name}.part").rename(folder / name)
    return 1


def at_once(folder, name, text):
    (folder / name).write_text(text)
    return 1


def slowly_by_one_writer(folder, name, text):
    """Longer than files have to be still: the writer has it open."""
    with open(folder / name, "w") as file:
        for i in range(4):
            file.write(text[i * len(text) // 4:(i + 1) * len(text) // 4])
            file.flush()
            time.sleep(0.06)
    return 1


def piece_by_piece(folder, name, text):
    """Closed and opened again between the pieces."""
    for i in range(4):
        with open(folder / name, "a") as file:
            file.write(text[i * len(text) // 4:(i + 1) * len(text) // 4])
        time.sleep(0.03)
    return 1


def truncated_and_written_again(folder, name, text):
    (folder / name).write_text(text.replace("begin", "wrong").replace("end", "wrong"))
    with open(folder / name, "w") as file:
        time.sleep(0.2)
        file.write(text)
    return 1


def empty_at_first(folder, name, text):
    (folder / name).touch()
    with open(folder / name, "r+") as file:
        time.sleep(0.2)
        file.write(text)
    return 1


def through_a_mapping(folder, name, text):
    with open(folder / name, "w+b") as file:
        file.truncate(len(text))
        with mmap.mmap(file.fileno(), len(text)) as view:
            view[:] = text.encode()
            view.flush()
    return 1


def copied_by_a_program(folder, name, text):
    source = folder.parent / f"{folder.name}-{name}"
    source.write_text(text)
    subprocess.run(["cp", "-p", source, folder / name], check=True)
    source.unlink()
    return 1


def moved_from_elsewhere(folder, name, text):
    source = folder.parent / f"{folder.name}-{name}"
    source.write_text(text)
    source.rename(folder / name)
    return 1


def hard_linked(folder, name, text):
    source = folder.parent / f"{folder.name}-{name}"
    source.write_text(text)
    os.link(source, folder / name)
    source.unlink()
    return 1


def read_only(folder, name, text):
    (folder / f".{name}").write_text(text)
    (folder / f".{name}").chmod(0o444)
    (folder / f".{name}").rename(folder / name)
    return 1


def from_the_last_century(folder, name, text):
    (folder / f".{name}").write_text(text)
    os.utime(folder / f".{name}", (915148800, 915148800))
    (folder / f".{name}").rename(folder / name)
    return 1


def from_the_future(folder, name, text):
    (folder / f".{name}").write_text(text)
    os.utime(folder / f".{name}", (4102444800, 4102444800))
    (folder / f".{name}").rename(folder / name)
    return 1


def deleted_soon(folder, name, text):
    (folder / name).write_text(text)
    time.sleep(0.1)
    try:
        (folder / name).unlink()
        return 0
    except FileNotFoundError:
        return 1  # it was taken


def deleted_while_it_is_written(folder, name, text):
    with open(folder / name, "w") as file:
        file.write(text[:len(text) // 2])
        file.flush()
        (folder / name).unlink()
    return 0


def a_symbolic_link(folder, name, text):
    target = folder.parent / f"{folder.name}-{name}"
    target.write_text(text)
    (folder / name).symlink_to(target)
    return 0


def a_folder(folder, name, text):
    (folder / name).mkdir()
    (folder / name / "inner.gcode").write_text(text)
    return 0


WAYS = [renamed, part_then_renamed, at_once, slowly_by_one_writer, piece_by_piece, truncated_and_written_again, empty_at_first,
        through_a_mapping, copied_by_a_program, moved_from_elsewhere, hard_linked, read_only, from_the_last_century,
        from_the_future, deleted_soon, deleted_while_it_is_written, a_symbolic_link, a_folder]
