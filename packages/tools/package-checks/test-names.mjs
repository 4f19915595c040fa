import { parseSync, Visitor } from 'oxc-parser';

/** `test`, and tests that need something besides: `gpuTest`, `firefoxTest`. */
const TEST_FUNCTION = /^(?:test|it|describe|\w+Test)$/;

/**
 * Returns the names of the tests in a script, and of groups of them, as they are written; for tests
 * called `$name`, also the names of their cases. Tests that are always skipped are left out.
 *
 * @param {string} path for messages; its ending says how to parse.
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

/** Names behind `test` in `test.skip()` and `test.each([])()`; null if it is no test. */
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
