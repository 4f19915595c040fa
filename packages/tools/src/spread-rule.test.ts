import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { type CallExpression, parseSync, Visitor } from 'oxc-parser';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** Code that handles what is in files. */
const READS_FILES = /^packages\/core\/src\/io\/(?!.*(?:\.test|-fixture)\.ts$).*\.ts$/;

/** Lists that a module passes as arguments, as `line: text`. One that is written out at its call is as long as it is there. */
function spreadCalls(path: string, text: string): string[] {
  const found: string[] = [];
  const check = ({ arguments: given }: Pick<CallExpression, 'arguments'>) => {
    for (const each of given) {
      if (each.type !== 'SpreadElement' || each.argument.type === 'ArrayExpression') continue;
      found.push(`${text.slice(0, each.start).split('\n').length}: ${text.slice(each.start, each.end)}`);
    }
  };
  new Visitor({ CallExpression: check, NewExpression: check }).visit(parseSync(path, text).program);
  return found;
}

/**
 * @fault Files: a file holds a list of any length
 * @consequence no reader passes a list as the arguments of a call, which overflows the stack
 */
test('no list from a file becomes the arguments of a call, which overflow the stack', () => {
  const paths = repositoryFiles(root).filter((path) => READS_FILES.test(path));
  expect(paths.length).toBeGreaterThan(100);
  const found = paths.flatMap((path) =>
    spreadCalls(path, readFileSync(join(root, path), 'utf8')).map((call) => `${path}:${call}`),
  );
  expect(found).toEqual([]);
});

test('the rule on lists as arguments finds them in calls and constructors, and no others', () => {
  const text = 'f(...a);\nnew B(1, ...c.d());\ng(...[1, 2]);\nh([...a], { ...b });';
  expect(spreadCalls('a.ts', text)).toEqual(['1: ...a', '2: ...c.d()']);
});
