import { parseSync, Visitor } from 'oxc-parser';

/** `test`, and tests with special requirements: `gpuTest`, `firefoxTest`. */
const TEST_FUNCTION = /^(?:test|it|describe|\w+Test)$/;

/**
 * Returns the names of tests and groups in a script, as written. For tests named `$name`, includes
 * their cases' names. Tests that are always skipped are left out.
 *
 * @param {string} path for messages; its extension selects the parser.
 * @param {string} text
 * @returns {string[]}
 */
export function testNames(path, text) {
  const { program, errors } = parseSync(path, text);
  if (errors.length > 0) throw new SyntaxError(`${path} does not parse: ${errors[0].message}`);
  const names = [];
  const caseNames = [];
  let skippedUntil = 0;
  // Groups are visited before the tests in them.
  new Visitor({
    CallExpression({ callee, arguments: [name], start, end }) {
      const members = membersOf(callee);
      if (!members || start < skippedUntil) return;
      if (members.some((member) => member === 'skip' || member === 'todo')) skippedUntil = end;
      else if (name?.type === 'Literal' && typeof name.value === 'string') names.push(name.value);
      else if (name?.type === 'TemplateLiteral') names.push(text.slice(name.start + 1, name.end - 1));
    },
    Property({ key, value, start }) {
      if (key.name === 'name' && typeof value.value === 'string' && start >= skippedUntil)
        caseNames.push(value.value);
    },
  }).visit(program);
  return names.includes('$name') ? [...names, ...caseNames] : names;
}

/** Names after `test` in `test.skip()` and `test.each([])()`; null for other calls. */
function membersOf(callee) {
  switch (callee.type) {
    case 'Identifier':
      return TEST_FUNCTION.test(callee.name) ? [] : null;
    case 'CallExpression':
      return membersOf(callee.callee);
    case 'MemberExpression': {
      const members = membersOf(callee.object);
      return members && [...members, callee.property.name];
    }
    default:
      return null;
  }
}
