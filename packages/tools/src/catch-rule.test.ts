import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { type Function as Declared, type Node, parseSync, type Statement, Visitor } from 'oxc-parser';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** Code that users or developers run, without its tests. */
const CODE = /^(?:apps|packages|e2e)\/(?!.*\.(?:test|d)\.).*\.(?:tsx?|mts|mjs)$/;

/** What every place has that may drop an error: other modules need not be parsed. */
const MAY_DROP =
  /\bcatch\b|\.then\(|\b(?:on|once|addEventListener)\(['"`]\w*(?:error|reject)|\.on\w*error =/i;

/** Another error, or a message in its place: a notice of the viewer, or a text with several words. */
const REPORTS = /\b(?:throw|reject)\b|\bnotice\b|(['"`])(?:(?!\1).)* (?:(?!\1).)*\1/is;

/** A `catch`, or a function that takes a rejection or an event of an error. */
interface Handler {
  readonly start: number;
  readonly end: number;
  /** Where a comment may stand before it: the first lines of its call and its statement. */
  readonly starts: readonly number[];
  readonly parameter: Node | null | undefined;
  readonly body: Node | null | undefined;
}

/**
 * Lists places that drop an error without a reason, as `line: text`. A handler that does not use its
 * error has a comment in it, on the line above it, above its call or above its statement, unless it
 * throws or tells something else. Handlers on adjacent lines may share a comment.
 */
function droppedErrors(path: string, text: string): string[] {
  if (!MAY_DROP.test(text)) return [];
  const { program, comments } = parseSync(path, text);
  const breaks = Array.from(text.matchAll(/\n/g), ({ index }) => index);
  const lineAt = (position: number) => breaks.findLastIndex((each) => each < position) + 2;
  const statements: Pick<Statement, 'start' | 'end'>[] = [];
  const handlers: Handler[] = [];
  const take = (
    { start, end }: Handler['body'] & object,
    callStart: number,
    { parameter, body }: Pick<Handler, 'parameter' | 'body'>,
  ) => {
    const statement = statements.findLast((each) => each.start <= start && end <= each.end);
    handlers.push({ start, end, starts: [start, callStart, statement?.start ?? start], parameter, body });
  };
  const takeFunction = (node: Node | undefined, callStart: number) => {
    if (node?.type !== 'ArrowFunctionExpression' && node?.type !== 'FunctionExpression') return;
    const { params, body } = node as Declared;
    take(node, callStart, { parameter: params[0] as Node | undefined, body: body as Node });
  };
  const takeStatement = (node: Pick<Statement, 'start' | 'end'>) => void statements.push(node);
  // Parents are visited before their children.
  new Visitor({
    ExpressionStatement: takeStatement,
    VariableDeclaration: takeStatement,
    ReturnStatement: takeStatement,
    TryStatement: takeStatement,
    IfStatement: takeStatement,
    ForOfStatement: takeStatement,
    CatchClause: (node) => take(node, node.start, { parameter: node.param as Node, body: node.body }),
    CallExpression({ callee, arguments: given }) {
      if (callee.type !== 'MemberExpression' || callee.property.type !== 'Identifier') return;
      const { name, start } = callee.property;
      if (name === 'catch') takeFunction(given[0], start);
      else if (name === 'then') takeFunction(given[1], start);
      else if (/^(?:on|once|addEventListener)$/.test(name) && /error|reject/i.test(textOf(given[0])))
        takeFunction(given[1], start);
    },
    AssignmentExpression({ left, right }) {
      if (/\.on\w*error$/i.test(textOf(left))) takeFunction(right, left.start);
    },
  }).visit(program);

  function textOf(node: Node | null | undefined): string {
    return node ? text.slice(node.start, node.end) : '';
  }

  let explainedTo = -1;
  return handlers
    .toSorted((a, b) => a.start - b.start)
    .flatMap(({ start, end, starts, parameter, body }) => {
      const names = textOf(parameter).match(/[\w$]+/g) ?? [];
      if (
        names.some((name) =>
          textOf(body)
            .match(/[\w$]+/g)
            ?.includes(name),
        )
      )
        return [];
      if (REPORTS.test(textOf(body))) return [];
      const above = starts.map((each) => lineAt(each) - 1);
      const isExplained =
        above.includes(explainedTo) ||
        comments.some((each) => (start < each.start && each.end < end) || above.includes(lineAt(each.end)));
      if (isExplained) explainedTo = lineAt(end);
      return isExplained ? [] : [`${lineAt(start)}: ${text.slice(start, end).replace(/\s+/g, ' ')}`];
    });
}

/**
 * @fault Pages and packages: code drops an error
 * @consequence every place that drops an error says who reports it, or why it does not matter
 */
test('code that drops an error says why', () => {
  const paths = repositoryFiles(root).filter((path) => CODE.test(path));
  expect(paths.length).toBeGreaterThan(1000);
  const found = paths.flatMap((path) =>
    droppedErrors(path, readFileSync(join(root, path), 'utf8')).map((dropped) => `${path}:${dropped}`),
  );
  expect(found).toEqual([]);
});

test.each([
  ['a catch without a body', 'try { f(); } catch {}', '1: catch {}'],
  [
    'a catch that returns something else',
    'try { f(); }\ncatch (e) { return 1; }',
    '2: catch (e) { return 1; }',
  ],
  ['a rejection that is dropped', 'f().catch(() => {});', '1: () => {}'],
  ['a second function of then', 'f().then(g, () => null);', '1: () => null'],
  ['a listener without a body', "stream.on('error', () => {});", '1: () => {}'],
  ['a comment on another statement', '// So.\nf();\ng().catch(() => {});', '3: () => {}'],
])('the rule on dropped errors finds %s', (_, text, found) => {
  expect(droppedErrors('a.ts', text)).toEqual([found]);
});

test.each([
  ['a reason in it', 'try { f(); } catch {\n  // g reports it.\n}'],
  ['a reason above', '// g reports it.\nconst a = await f().catch(() => null);'],
  ['a reason above its call', 'f()\n  // g reports it.\n  .then(\n    h,\n    () => {},\n  );'],
  ['a reason that it shares', '// Both.\na.catch(() => {});\nb.catch(() => {});'],
  ['its error in use', 'f().catch((error) => report(error));'],
  ['another error', "try { f(); } catch { throw new Error('No.'); }"],
  ['a message', "try { f(); } catch { status = 'This file is no report.'; }"],
])('the rule on dropped errors takes %s', (_, text) => {
  expect(droppedErrors('a.ts', text)).toEqual([]);
});
