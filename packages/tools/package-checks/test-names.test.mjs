import { expect, test } from 'vitest';
import { testNames } from './test-names.mjs';

test.each([
  ["test('a name', () => {})", ['a name']],
  ["describe('a group', () => { it('a name', { timeout: 1 }, async () => {}) })", ['a group', 'a name']],
  ["gpuTest.each([['no name', 1]])('of %s', () => {})", ['of %s']],
  ["describe.skipIf(!found)('a group', () => {})", ['a group']],
  // biome-ignore lint/suspicious/noTemplateCurlyInString: the name as it is written.
  ['for (const n of [1]) test(`of ${n}: it`, () => {})', ['of ${n}: it']],
  ["const cases = [{ name: 'a' }]; test.each(cases)('$name', () => {})", ['$name', 'a']],
  ["const file = { name: 'a' }; test('of it', () => {})", ['of it']],
  ["// test('a comment')\nconst text = \"test('a text')\"; log('a call');", []],
  ["test.skip('a name', () => {}); test.todo('a name'); test('another', () => {})", ['another']],
  ["describe.skip('a group', () => { test('a name', () => {}) }); test('another')", ['another']],
])('%s has the tests %j', (text, names) => {
  expect(testNames('some.test.ts', text)).toEqual(names);
});

test('a script that does not parse is refused by name', () => {
  expect(() => testNames('some.test.ts', 'test(')).toThrow('some.test.ts does not parse');
});
