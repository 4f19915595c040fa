// Places of a module where one small change makes other code, which some test should notice.
import { parseSync, Visitor } from 'oxc-parser';

/** The operator that takes the place of each. */
const OTHER = {
  '+': '-',
  '-': '+',
  '*': '/',
  '/': '*',
  '%': '*',
  '<': '<=',
  '<=': '<',
  '>': '>=',
  '>=': '>',
  '===': '!==',
  '!==': '===',
  '==': '!=',
  '!=': '==',
  '&&': '||',
  '||': '&&',
  '&': '|',
  '|': '&',
  '<<': '>>',
  '>>': '<<',
  '>>>': '<<',
  '+=': '-=',
  '-=': '+=',
  '*=': '/=',
  '|=': '&=',
};

/**
 * A change of one place: the text from `start` to `end` becomes `text`.
 *
 * @typedef {{ start: number, end: number, text: string }} Mutant
 */

/**
 * Lists the mutants of a module of TypeScript or WGSL, in the order of their places.
 *
 * @param {string} path
 * @param {string} text
 * @returns {Mutant[]}
 */
export function mutantsOf(path, text) {
  const mutants = path.endsWith('.wgsl') ? wgslMutants(text) : scriptMutants(path, text);
  return mutants.sort((a, b) => a.start - b.start);
}

function scriptMutants(path, text) {
  const mutants = [];
  const types = [];
  const add = (start, end, other) => mutants.push({ start, end, text: other });
  const textOf = ({ start, end }) => text.slice(start, end);
  const operator = ({ left, right, operator: found }) => {
    const other = OTHER[found];
    const start = text.indexOf(found, left.end);
    // Texts that are joined say the same to a test that asks for a part of them.
    if (other && start < right.start && !/['"`]/.test(textOf(left) + textOf(right)))
      add(start, start + found.length, other);
  };
  new Visitor({
    BinaryExpression: operator,
    LogicalExpression: operator,
    AssignmentExpression: operator,
    Literal(node) {
      if (typeof node.value === 'number')
        add(node.start, node.end, node.value === 0 ? '1' : `(${textOf(node)} + 1)`);
    },
    UnaryExpression({ operator: found, start, argument }) {
      if (found === '!' || found === '-') add(start, argument.start, '');
    },
    ConditionalExpression({ consequent, alternate }) {
      add(consequent.start, alternate.end, `${textOf(alternate)} : ${textOf(consequent)}`);
    },
    TSLiteralType(node) {
      types.push(node);
    },
    CallExpression({ arguments: given }) {
      if (
        given.length === 2 &&
        given.every(({ type }) => type === 'Identifier' || type === 'MemberExpression')
      )
        add(given[0].start, given[1].end, `${textOf(given[1])}, ${textOf(given[0])}`);
    },
  }).visit(parseSync(path, text).program);
  return mutants.filter(({ start, end }) => !types.some((type) => type.start <= start && end <= type.end));
}

/** Code of WGSL: neither comments nor imports, attributes or the types of declarations. */
const NO_CODE = /\/\/.*|^\s*import .*|@\w+(?:\([^)]*\))?|array<[^>]*>|:\s*[\w<>, ]+/gm;
const WGSL_PLACES = [
  [/ (\+|-|\*|\/|%|<|<=|>|>=|==|!=|&&|\|\||&|\||<<|>>|\+=|-=|\*=|\|=) /g, (found) => OTHER[found]],
  [/(?<![\w.])(\d+)(?=u?\b(?!\.))/g, (found) => (found === '0' ? '1' : String(Number(found) + 1))],
  [/(?<![\w.])(\d+\.\d+)(?![\w.])/g, (found) => (Number(found) === 0 ? '1.0' : `(${found} * 2.0)`)],
  [/\b(min|max)(?=\()/g, (found) => (found === 'min' ? 'max' : 'min')],
  [/(?<=\.)(xy|yx|xz|yz|zw)\b/g, (found) => [...found].reverse().join('')],
  [/(?<=\w\.)(x|y|z|w)\b/g, (found) => (found === 'x' ? 'y' : 'x')],
];

function wgslMutants(text) {
  // Of the same length, so that places stay.
  const code = text.replace(NO_CODE, (found) => found.replace(/[^\n]/g, ' '));
  return WGSL_PLACES.flatMap(([pattern, other]) =>
    Array.from(code.matchAll(pattern), (match) => {
      const start = match.index + match[0].indexOf(match[1]);
      return { start, end: start + match[1].length, text: other(match[1]) };
    }),
  ).filter(({ text: other }) => other !== undefined);
}
