import { parseSync, Visitor } from 'oxc-parser';

/**
 * Finds places in a script that evaluate code from text, which a content security policy without
 * 'unsafe-eval' forbids: `eval`, `Function`, and timers with a string.
 *
 * @param {string} path for messages; its extension selects the parser.
 * @param {string} text
 * @returns {string[]} one line per place: path, line and the called function.
 */
export function codeFromText(path, text) {
  const { program, errors } = parseSync(path, text);
  if (errors.length > 0) throw new SyntaxError(`${path} does not parse: ${errors[0].message}`);
  const found = [];
  const check = ({ callee, arguments: given, start }) => {
    const name = calledName(callee);
    const isTimer = name === 'setTimeout' || name === 'setInterval';
    if (name !== 'eval' && name !== 'Function' && !(isTimer && isText(given[0]))) return;
    found.push(`${path}:${text.slice(0, start).split('\n').length}: ${name} makes code from text`);
  };
  new Visitor({ CallExpression: check, NewExpression: check }).visit(program);
  return found;
}

/** The name in `name()`, `(0, name)()` and `globalThis.name()`. */
function calledName(callee) {
  switch (callee.type) {
    case 'Identifier':
      return callee.name;
    case 'ParenthesizedExpression':
      return calledName(callee.expression);
    case 'SequenceExpression':
      return calledName(callee.expressions.at(-1));
    case 'MemberExpression': {
      const isGlobal = ['globalThis', 'window', 'self'].includes(callee.object.name);
      return isGlobal ? callee.property.name : undefined;
    }
  }
}

function isText(node) {
  return node?.type === 'TemplateLiteral' || (node?.type === 'Literal' && typeof node.value === 'string');
}
