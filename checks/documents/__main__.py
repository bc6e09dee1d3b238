"""``python -m checks.documents``: write every document that is made from the program."""

from checks import documents
from checks import reports as files
from checks.documents import commands, drawing, packages, promises, reading, versions


def main() -> None:
    for path, text in packages.declared().items():
        path.write_text(text, encoding="utf-8")
    documents.SCENE.write_text(documents.scene_page(), encoding="utf-8")
    documents.COMMANDS.write_text(commands.page(), encoding="utf-8")
    text = documents.VERSIONS.read_text(encoding="utf-8")
    documents.VERSIONS.write_text(versions.with_versions(text, documents.ROOT), encoding="utf-8")
    text = documents.README.read_text(encoding="utf-8")
    documents.README.write_text(documents.with_screen(text, documents.screen()), encoding="utf-8")
    drawing.draw(documents.DRAWING)
    reading.draw()
    promises.draw_stability(files.read()["stability"], documents.STABILITY)


if __name__ == "__main__":
    main()
