"""Results as one self-contained HTML page. Depends on: plots and the results it draws; jinja2 when writing.

    report("brake.toml", "brake.html")          a design examined from every side
    report(result, "result.html")               any result, or a file that holds one
    write_page(Page(...), "page.html")          a page of your own, of the blocks below

A page is data: a title and sections of text, tables, pictures, charts, sounds and code, nested where some of it should
be folded away. Pictures are embedded, styles are inside, nothing is fetched, everything given is escaped. It reads in
light and dark, on a narrow screen and on paper.
"""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
