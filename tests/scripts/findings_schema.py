"""Writes docs/bpa-findings-2.schema.json, and the section "Every field" of docs/findings.md, from src/findings/lib.rs.

    python3 tests/scripts/findings_schema.py        # from the root of the repository

tests/it/findings_schema.rs checks what it wrote against what the program writes.
"""

import json
import re

SOURCE = "src/findings/lib.rs"
SCHEMA = "docs/bpa-findings-2.schema.json"
PAGE = "docs/findings.md"
SECTION = "## Every field\n"
LEFT_OUT = {"Residuals"}  # for figures, in no file

PLAIN = {
    "String": ({"type": "string"}, "string"),
    "f64": ({"type": ["number", "null"]}, "number"),  # null where it is not finite
    "u32": ({"type": "integer", "minimum": 0}, "integer"),
    "usize": ({"type": "integer", "minimum": 0}, "integer"),
    "bool": ({"type": "boolean"}, "boolean"),
}


def kind(rust):
    """JSON Schema and words of a Rust type."""
    rust = rust.strip()
    if rust.startswith("Option<"):
        schema, words = kind(rust[7:-1])
        if isinstance(schema.get("type"), str):
            return {**schema, "type": [schema["type"], "null"]}, words + " or null"
        return ({"anyOf": [schema, {"type": "null"}]} if "$ref" in schema else schema), words + " or null"
    if rust.startswith("Vec<"):
        schema, words = kind(rust[4:-1])
        return {"type": "array", "items": schema}, "list of " + words
    if rust.startswith("BTreeMap<String,"):
        schema, words = kind(rust[16:-1])
        return {"type": "object", "additionalProperties": schema}, "object of " + words
    if rust.startswith("["):
        inner, n = rust[1:-1].split(";")
        schema, words = kind(inner)
        return {"type": "array", "items": schema, "minItems": int(n), "maxItems": int(n)}, f"list of {n.strip()} {words}s"
    if rust.startswith("("):
        parts = [kind(part) for part in rust[1:-1].split(",")]
        items = [schema for schema, _ in parts]
        same = all(item == items[0] for item in items)
        schema = {"items": items[0]} if same else {"prefixItems": items}
        words = ", ".join(words for _, words in parts)
        return {"type": "array", **schema, "minItems": len(items), "maxItems": len(items)}, f"pair ({words})"
    return PLAIN.get(rust) or ({"$ref": f"#/$defs/{rust}"}, f"[`{rust}`](#{rust.lower()})")


def snake(name):
    return re.sub(r"(?<!^)([A-Z])", r"_\1", name).lower()


def said(lines):
    """A documentation comment as plain text."""
    text = " ".join(line.strip()[3:].strip() for line in lines)
    text = text.replace("[`SCHEMA`]", "`bpa-findings/2`").replace("[`Verdict::NotAssessed`]", "`not_assessed`")
    return re.sub(r"\[`(?:\w+::)?(\w+)`\]", r"`\1`", text)


def declarations(source):
    """Every struct and enum: name, whether it is a struct, what is said of it, its fields or values."""
    pattern = r"((?:///[^\n]*\n)+)(?:#\[[^\n]*\]\n)*pub (struct|enum) (\w+) \{\n(.*?)\n\}"
    for doc, what, name, body in re.findall(pattern, source, re.S):
        entries, comment, absent = [], [], False
        for line in map(str.strip, body.split("\n")):
            if line.startswith("///"):
                comment.append(line)
            elif line.startswith("#["):
                absent = "skip_serializing_if" in line
            elif line:
                field = re.match(r"pub (\w+): (.*),$", line)
                key, rust = field.groups() if field else (snake(line.rstrip(",")), None)
                entries.append((key, rust, said(comment), absent))
                comment, absent = [], False
        if name not in LEFT_OUT:
            yield name, what == "struct", said(doc.strip().split("\n")), entries


def definition(is_struct, doc, entries):
    if not is_struct:
        return {"description": doc, "enum": [key for key, *_ in entries]}
    properties = {key: {**kind(rust)[0], "description": text} for key, rust, text, _ in entries}
    required = [key for key, _, _, absent in entries if not absent]
    return {"description": doc, "type": "object", "additionalProperties": False, "required": required, "properties": properties}


def section(name, is_struct, doc, entries):
    lines = [f"### {name}", "", doc, ""]
    if is_struct:
        lines += ["| field | type | what |", "|---|---|---|"]
        for key, rust, text, absent in entries:
            lines.append(f"| `{key}` | {kind(rust)[1]}{' (may be absent)' if absent else ''} | {text} |")
    else:
        lines += ["| value | means |", "|---|---|"]
        lines += [f"| `{key}` | {text} |" for key, _, text, _ in entries]
    return "\n".join(lines) + "\n"


def main():
    with open(SOURCE, encoding="utf-8") as file:
        all_of_them = list(declarations(file.read()))
    defs = {name: definition(*rest) for name, *rest in all_of_them}
    root = defs.pop("Findings")
    root["properties"]["schema"] = {"const": "bpa-findings/2"}
    root["description"] = "The answers of the residual search, as values. A number that is not finite is null."
    draft = "https://json-schema.org/draft/2020-12/schema"
    with open(SCHEMA, "w", encoding="utf-8") as file:
        json.dump({"$schema": draft, "title": "bpa-findings/2", **root, "$defs": defs}, file, indent=2, ensure_ascii=False)
        file.write("\n")
    with open(PAGE, encoding="utf-8") as file:
        before = file.read().split(SECTION)[0]
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(before + SECTION + "\n" + "\n".join(section(*each) for each in all_of_them))


if __name__ == "__main__":
    main()
