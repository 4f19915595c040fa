import { expect, test } from 'vitest';
import { codeFromText } from './code-from-text.mjs';

/**
 * @fault Pages and packages: a build contains code that makes code from text
 * @consequence `npm run check` fails with the place
 */
test.each([
  'eval("1")',
  '(0, eval)(text)',
  'globalThis.eval(text)',
  'new Function("a", "return a")',
  'Function("return this")()',
  'setTimeout("go()", 1)',
  'setInterval(`go()`, 1)',
])('%s makes code from text', (script) => {
  expect(codeFromText('a.js', `let a;\n${script};`)).toEqual([expect.stringMatching(/^a\.js:2: \w+ makes/)]);
});

test.each([
  '"eval(1)"',
  '// new Function()',
  'setTimeout(() => {}, 1)',
  'value instanceof Function',
  'session.eval(text)',
])('%s does not', (script) => {
  expect(codeFromText('a.js', script)).toEqual([]);
});
