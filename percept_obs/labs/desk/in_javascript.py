"""The reader's Python as JavaScript for the page, so that names are told apart by one text only.

Only what the modules of the reader use is known: what else somebody writes there is refused with its line.  Python's
functions and methods stand in ``front/src/desk/model/python.js``; constants are printed as the values that they have.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
from collections.abc import Iterable, Mapping
from types import ModuleType
from typing import Any

_RESERVED = {"new", "function", "default", "this", "var", "let", "const", "case", "switch", "delete", "typeof", "void"}
_COMPARED = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_OPERATIONS = {
    ast.Add: "add",
    ast.Mult: "mul",
    ast.Sub: "sub",
    ast.BitOr: "or",
    ast.FloorDiv: "floor",
}


def in_javascript(modules: Iterable[ModuleType], left_out: Iterable[str], known: Iterable[str]) -> str:
    """Return modules as one module in JavaScript; names that are left out are those of `known`, which it imports."""
    parts: list[str] = []
    names, constants = set(known), set[str]()
    trees = [(module, ast.parse(inspect.getsource(module))) for module in modules]
    for _, tree in trees:
        names |= {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        constants |= {name.id for node in tree.body for target in _targets(node) for name in _stored(target)}
    signatures = {name: _signature(node) for _, tree in trees for name, node in _functions(tree)}
    printer = _Printer(signatures, names | constants)
    for module, tree in trees:
        for node in tree.body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name not in left_out:
                parts.append(printer.visit(node))
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                for name in [part.id for target in _targets(node) for part in _stored(target)]:
                    if name not in left_out and not name.startswith("__"):
                        value = getattr(module, name)
                        text = f"py.constant({name!r}, {str(isinstance(value, Mapping)).lower()})"
                        parts.append(f"const {name} = {text if _is_long(value) else literal(value)};")
    exported = ", ".join(sorted(name for name in names if name not in left_out and name not in known))
    names_of = ", ".join(module.__name__ for module, _ in trees)
    head = f"// @ts-nocheck\n// Printed by Python from {names_of}: change those, not this.\n"
    head += f'import {{ py, {", ".join(sorted(known))} }} from "./python.js";\n'
    text = "\n".join([*parts, f"export {{ {exported} }};", ""])
    # as names of their own, which the bundle shortens
    used = sorted(set(re.findall(r"\bpy\.(?:methods\.)?\w+", text)), key=len, reverse=True)
    for name in used:
        text = re.sub(rf"\b{re.escape(name)}\b", name.replace(".", "_"), text)
    return "\n".join([head, *(f"const {name.replace('.', '_')} = {name};" for name in sorted(used)), text])


def long_constants(modules: Iterable[ModuleType]) -> dict[str, Any]:
    """Return dictionaries and regular expressions that the page has among its tables, by their names."""
    found = {name: value for module in modules for name, value in vars(module).items() if _is_long(value)}
    return {
        name: value.pattern
        if isinstance(value, re.Pattern)
        else {k: True if callable(v) else v for k, v in value.items()}
        for name, value in found.items()
        if not name.startswith("__")
    }


def _is_long(value: Any) -> bool:
    return (isinstance(value, Mapping) and len(value) > 10) or (
        isinstance(value, re.Pattern) and len(value.pattern) > 60
    )


def literal(value: Any) -> str:
    """Return a constant in JavaScript; of functions only that they are there."""
    if isinstance(value, re.Pattern):
        return f"py.pattern({json.dumps(value.pattern)})"
    if isinstance(value, Mapping):
        return f"new Map(Object.entries({{ {', '.join(f'{literal(k)}: {literal(v)}' for k, v in value.items())} }}))"
    if isinstance(value, set | frozenset):
        return f"new Set({json.dumps(' '.join(sorted(value)))}.split(' '))"
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(literal, value))}]"
    return "true" if callable(value) else json.dumps(value)


def _functions(tree: ast.AST) -> Iterable[tuple[str, ast.FunctionDef]]:
    return [(node.name, node) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def _signature(node: ast.FunctionDef) -> list[str]:
    return [arg.arg for arg in node.args.args if arg.arg != "self"]


class _Printer(ast.NodeVisitor):
    """Prints nodes; a method named like a node returns its text."""

    def __init__(self, signatures: Mapping[str, list[str]], names: set[str]) -> None:
        self.signatures, self.names, self.local = signatures, names, [set[str]()]

    def generic_visit(self, node: ast.AST) -> str:
        raise ValueError(f"line {getattr(node, 'lineno', '?')}: {type(node).__name__} has no JavaScript here")

    def all(self, nodes: Iterable[ast.AST], between: str = ", ") -> str:
        return between.join(map(self.visit, nodes))

    # What is defined.

    def visit_ClassDef(self, node: ast.ClassDef) -> str:
        methods = [each for each in node.body if isinstance(each, ast.FunctionDef)]
        base = f" extends {self.visit(node.bases[0])}" if node.bases else ""
        return f"class {node.name}{base} {{\n{''.join(self.function(each, method=True) for each in methods)}}}"

    def visit_FunctionDef(self, node: ast.FunctionDef) -> str:
        return self.function(node)

    def function(self, node: ast.FunctionDef, method: bool = False) -> str:
        arguments = self.arguments(node.args)
        stars = "*" if any(isinstance(part, ast.Yield | ast.YieldFrom) for part in _own(node)) else ""
        given = {arg.arg for arg in node.args.args}
        names = sorted(_assigned(node) - given)
        inside = {part.name for part in ast.walk(node) if isinstance(part, ast.FunctionDef | ast.ExceptHandler)}
        self.local.append({*given, *names, *map(str, inside)})
        body = [f"let {', '.join(map(_named, names))};"] if names else []
        body += ["const self = this;"] if method else []
        text = "\n".join([*body, *map(self.visit, node.body)])
        self.local.pop()
        getter = "get " if any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list) else ""
        name = "constructor" if node.name == "__init__" else _named(node.name)
        return f"{getter}{'' if method else 'function'}{stars} {name}({arguments}) {{\n{text}\n}}\n"

    def arguments(self, node: ast.arguments) -> str:
        given = [arg.arg for arg in node.args if arg.arg != "self"]
        values = dict(zip(reversed(given), reversed(list(map(self.visit, node.defaults))), strict=False))
        listed = [f"{_named(name)} = {values[name]}" if name in values else _named(name) for name in given]
        return ", ".join([*listed, *([f"...{node.vararg.arg}"] if node.vararg else [])])

    # Statements.

    def block(self, nodes: Iterable[ast.stmt]) -> str:
        return "{\n" + self.all(nodes, "\n") + "\n}"

    def visit_Expr(self, node: ast.Expr) -> str:
        if isinstance(node.value, ast.Constant):
            return ""  # a docstring
        return f"{self.visit(node.value)};"

    def visit_Return(self, node: ast.Return) -> str:
        return f"return {self.visit(node.value) if node.value else 'null'};"

    def visit_Assign(self, node: ast.Assign) -> str:
        (target,) = node.targets
        return self.assigned(target, self.visit(node.value))

    def assigned(self, target: ast.expr, value: str) -> str:
        if isinstance(target, ast.Subscript):
            return f"py.put({self.visit(target.value)}, {self.index(target.slice)}, {value});"
        value = f"py.list({value})" if isinstance(target, ast.Tuple) else value
        return f"{self.visit(target)} = {value};"

    def visit_AnnAssign(self, node: ast.AnnAssign) -> str:
        return self.assigned(node.target, self.visit(node.value)) if node.value else ""

    def visit_AugAssign(self, node: ast.AugAssign) -> str:
        target = self.visit(node.target)
        name = _OPERATIONS[type(node.op)]
        value = f"py.{'i' if name == 'add' else ''}{name}({target}, {self.visit(node.value)})"
        return self.assigned(node.target, value)

    def visit_For(self, node: ast.For) -> str:
        return f"for ({self.visit(node.target)} of py.iter({self.visit(node.iter)})) {self.block(node.body)}"

    def visit_While(self, node: ast.While) -> str:
        return f"while ({self.test(node.test)}) {self.block(node.body)}"

    def visit_If(self, node: ast.If) -> str:
        other = f" else {self.block(node.orelse)}" if node.orelse else ""
        return f"if ({self.test(node.test)}) {self.block(node.body)}{other}"

    def visit_Raise(self, node: ast.Raise) -> str:
        return f"throw {self.visit(node.exc)};" if node.exc else "throw error_;"

    def visit_Try(self, node: ast.Try) -> str:
        (handler,) = node.handlers
        name = f"let {handler.name} = error_;" if handler.name else ""
        caught = f"if (!(error_ instanceof {self.visit(handler.type)})) throw error_;\n{name}" if handler.type else name
        return f"try {self.block(node.body)} catch (error_) {{\n{caught}{self.all(handler.body, chr(10))}\n}}"

    def visit_With(self, node: ast.With) -> str:
        call = node.items[0].context_expr
        if not (isinstance(call, ast.Call) and self.visit(call.func) == "py.suppress"):
            raise ValueError(f"line {node.lineno}: only suppress stands behind with")
        other = f"if (!(error_ instanceof {self.visit(call.args[0])})) throw error_;"
        return f"try {self.block(node.body)} catch (error_) {{ {other} }}"

    def visit_Delete(self, node: ast.Delete) -> str:
        (target,) = node.targets
        assert isinstance(target, ast.Subscript)
        return f"py.del({self.visit(target.value)}, {self.index(target.slice)});"

    def visit_Assert(self, node: ast.Assert) -> str:
        return ""

    def visit_Continue(self, node: ast.Continue) -> str:
        return "continue;"

    def visit_Break(self, node: ast.Break) -> str:
        return "break;"

    # Expressions.

    def visit_Name(self, node: ast.Name) -> str:
        free = not any(node.id in names for names in self.local)
        if free and node.id not in _PYTHON | self.names:
            raise ValueError(f"line {node.lineno}: {node.id} has no JavaScript here; write it in python.js")
        if free and node.id in _PYTHON:
            return f"py.{node.id}{'_' if node.id == 'set' else ''}"
        return _named(node.id)

    def visit_Constant(self, node: ast.Constant) -> str:
        return json.dumps(node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> str:
        parts = [str(part.value) if isinstance(part, ast.Constant) else self.visit(part) for part in node.values]
        texts = [isinstance(part, ast.Constant) for part in node.values]
        quoted = (
            re.sub(r"[`$\\]", r"\\\g<0>", part).replace("\n", "\\n") if text else f"${{{part}}}"
            for part, text in zip(parts, texts, strict=True)
        )
        return f"`{''.join(quoted)}`"

    def visit_FormattedValue(self, node: ast.FormattedValue) -> str:
        return f"py.{'repr' if node.conversion == ord('r') else 'str'}({self.visit(node.value)})"

    def visit_Tuple(self, node: ast.Tuple) -> str:
        return f"[{self.all(node.elts)}]"

    def visit_List(self, node: ast.List) -> str:
        return f"[{self.all(node.elts)}]"

    def visit_Set(self, node: ast.Set) -> str:
        return f"new Set([{', '.join(self.hashed(part) for part in node.elts)}])"

    def hashed(self, node: ast.expr) -> str:
        constant = isinstance(node, ast.Starred | ast.Constant)
        return self.visit(node) if constant else f"py.key({self.visit(node)})"

    def visit_Dict(self, node: ast.Dict) -> str:
        parts = [
            f"[{self.hashed(key)}, {self.visit(value)}]" if key else f"...{self.visit(value)}"
            for key, value in zip(node.keys, node.values, strict=True)
        ]
        return f"new Map([{', '.join(parts)}])"

    def visit_Starred(self, node: ast.Starred) -> str:
        return f"...py.iter({self.visit(node.value)})"

    def visit_BinOp(self, node: ast.BinOp) -> str:
        left, right = self.visit(node.left), self.visit(node.right)
        if re.fullmatch(r"\d+", right) and isinstance(node.op, ast.Add | ast.Sub):
            return f"({left} {'+' if isinstance(node.op, ast.Add) else '-'} {right})"
        return f"py.{_OPERATIONS[type(node.op)]}({left}, {right})"

    def visit_UnaryOp(self, node: ast.UnaryOp) -> str:
        return f"!({self.test(node.operand)})" if isinstance(node.op, ast.Not) else f"-{self.visit(node.operand)}"

    def visit_BoolOp(self, node: ast.BoolOp) -> str:
        if all(map(_is_boolean, node.values)):
            return self.test(node)
        which = "every" if isinstance(node.op, ast.And) else "some"
        first, *rest = map(self.visit, node.values)
        return f"py.{which}({first}, {', '.join(f'() => {each}' for each in rest)})"

    def test(self, node: ast.expr) -> str:
        """Return Python's truth of an expression."""
        if isinstance(node, ast.BoolOp):
            return f"({(' && ' if isinstance(node.op, ast.And) else ' || ').join(map(self.test, node.values))})"
        return self.visit(node) if _is_boolean(node) else f"py.t({self.visit(node)})"

    def visit_Compare(self, node: ast.Compare) -> str:
        sides = [self.visit(node.left), *map(self.visit, node.comparators)]
        parts = [self.compared(sides[k], op, sides[k + 1]) for k, op in enumerate(node.ops)]
        return parts[0] if len(parts) == 1 else f"({' && '.join(parts)})"

    def compared(self, left: str, op: ast.cmpop, right: str) -> str:
        if type(op) in _COMPARED:
            return f"py.compare({left}, {json.dumps(_COMPARED[type(op)])}, {right})"
        no = "!" if isinstance(op, ast.NotEq | ast.NotIn | ast.IsNot) else ""
        which = "in" if isinstance(op, ast.In | ast.NotIn) else "is" if isinstance(op, ast.Is | ast.IsNot) else "eq"
        return f"{no}py.{which}({left}, {right})"

    def visit_IfExp(self, node: ast.IfExp) -> str:
        return f"({self.test(node.test)} ? {self.visit(node.body)} : {self.visit(node.orelse)})"

    def visit_NamedExpr(self, node: ast.NamedExpr) -> str:
        return f"({self.visit(node.target)} = {self.visit(node.value)})"

    def visit_Lambda(self, node: ast.Lambda) -> str:
        self.local.append({arg.arg for arg in node.args.args})
        text = f"(({self.arguments(node.args)}) => {self.visit(node.body)})"
        self.local.pop()
        return text

    def visit_Subscript(self, node: ast.Subscript) -> str:
        return f"py.item({self.visit(node.value)}, {self.index(node.slice)})"

    def index(self, node: ast.expr) -> str:
        if not isinstance(node, ast.Slice):
            return self.visit(node)
        ends = [self.visit(end) if end else "null" for end in (node.lower, node.upper, node.step)]
        return f"py.slice({', '.join(ends)})"

    def visit_Attribute(self, node: ast.Attribute) -> str:
        owner = self.visit(node.value)
        if isinstance(node.ctx, ast.Load) and node.attr in self.signatures and owner == "self":
            return f'py.bound(self, "{node.attr}")'
        return f"{owner}.{node.attr}"

    def visit_Call(self, node: ast.Call) -> str:
        arguments = list(map(self.visit, node.args))
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if node.keywords and name in self.signatures:
            names = self.signatures[name]
            given = {_named(k.arg or ""): self.visit(k.value) for k in node.keywords}
            arguments += [given.get(_named(each), "undefined") for each in names[len(arguments) :]]
        elif node.keywords:
            given = {str(k.arg): self.visit(k.value) for k in node.keywords if k.arg != "strict"}
            arguments += [f"{{ {', '.join(f'{k}: {v}' for k, v in given.items())} }}"] if given else []
        listed = ", ".join(arguments)
        if not isinstance(node.func, ast.Attribute):
            function = self.visit(node.func)
            made = "new " if function[0].isupper() else ""
            return f"{made}{function}({listed})"
        owner = self.visit(node.func.value)
        if node.func.attr in _METHODS and owner not in ("self", "py.re"):
            return f"py.methods.{node.func.attr}({owner}{', ' if listed else ''}{listed})"
        if node.func.attr not in _METHODS | _OTHERS | set(self.signatures):
            raise ValueError(f"line {node.lineno}: the method {node.func.attr} has no JavaScript here")
        return f"{owner}.{node.func.attr}({listed})"

    def comprehension(self, node: Any, inner: str) -> str:
        if len(node.generators) == 1:
            (part,) = node.generators
            name, tests = self.visit(part.target), " && ".join(map(self.test, part.ifs))
            return f"py.gen({self.visit(part.iter)}, ({name}) => {inner}{f', ({name}) => {tests}' if tests else ''})"
        text = f"yield {inner};"
        for part in reversed(node.generators):
            for test in reversed(part.ifs):
                text = f"if ({self.test(test)}) {text}"
            text = f"for (const {self.visit(part.target)} of py.iter({self.visit(part.iter)})) {text}"
        return f"(function* () {{ {text} }})()"

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> str:
        self.local.append(_bound_in(node))
        text = self.comprehension(node, self.visit(node.elt))
        self.local.pop()
        return text

    def visit_ListComp(self, node: ast.ListComp) -> str:
        return f"py.list({self.visit_GeneratorExp(node)})"  # type: ignore[arg-type]

    def visit_DictComp(self, node: ast.DictComp) -> str:
        self.local.append(_bound_in(node))
        text = self.comprehension(node, f"[{self.visit(node.key)}, {self.visit(node.value)}]")
        self.local.pop()
        return f"py.dict({text})"

    def visit_Yield(self, node: ast.Yield) -> str:
        return f"yield {self.visit(node.value)}" if node.value else "yield null"


_PYTHON = {
    *("all", "any", "bool", "dict", "difflib", "enumerate", "hasattr"),
    *("int", "isinstance", "len", "list", "map", "max", "min", "next"),
    *("pairwise", "range", "re", "repr", "reversed", "set", "sorted", "str"),
    *("sum", "suppress", "unicodedata", "zip"),
}
_QUESTIONS = {
    *("all", "any", "endswith", "hasattr", "isalpha", "isascii", "isdigit", "isinstance"),
    *("isspace", "startswith"),
}
_OTHERS = {
    *("Symbol", "end", "findall", "finditer", "fullmatch", "get_close_matches", "groups"),
    *("match", "name", "normalize", "search", "span", "start", "sub", "update"),
}
"""Methods of tokens, of regular expressions, and of modules."""
_METHODS = {
    *("add", "append", "count", "endswith", "fromkeys", "get", "index"),
    *("isalpha", "isascii", "isdigit", "isspace", "items", "join", "lower"),
    *("lstrip", "pop", "removeprefix", "removesuffix", "replace", "rstrip", "setdefault", "split"),
    *("startswith", "strip", "values"),
}


def _is_boolean(node: ast.expr) -> bool:
    """Return True for expressions that are always true or false."""
    if isinstance(node, ast.BoolOp):
        return all(map(_is_boolean, node.values))
    name = getattr(getattr(node, "func", None), "id", getattr(getattr(node, "func", None), "attr", ""))
    negated = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    return negated or isinstance(node, ast.Compare) or name in _QUESTIONS


def _named(name: str) -> str:
    return f"{name}_" if name in _RESERVED else name


def _own(node: ast.AST) -> Iterable[ast.AST]:
    """Nodes of a function without those of functions in it."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.FunctionDef | ast.Lambda):
            yield child
            yield from _own(child)


def _assigned(node: ast.FunctionDef) -> set[str]:
    found: set[str] = set()
    for part in _own(node):
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            found.add(part.id)
    inside = {name for part in _own(node) if hasattr(part, "generators") for name in _bound_in(part)}
    outside = {
        name.id
        for part in _own(node)
        for target in _targets(part)
        for name in ast.walk(target)
        if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
    }
    return (found - inside) | outside


def _targets(node: ast.AST) -> list[ast.expr]:
    if isinstance(node, ast.Assign):
        return node.targets
    return [node.target] if isinstance(node, ast.For | ast.AnnAssign | ast.AugAssign | ast.NamedExpr) else []


def _stored(target: ast.expr) -> list[ast.Name]:
    return [part for part in ast.walk(target) if isinstance(part, ast.Name)]


def _bound_in(node: Any) -> set[str]:
    """Names that a comprehension binds."""
    return {n.id for part in node.generators for n in ast.walk(part.target) if isinstance(n, ast.Name)}
