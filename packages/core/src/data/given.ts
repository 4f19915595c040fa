import { InvalidArgumentError } from './errors.ts';
import { shown } from './printable.ts';

/** @throws InvalidArgumentError unless there are options at all. */
export function given<Options extends object>(options: Options): Options {
  if (typeof options === 'object' && options !== null) return options;
  throw new InvalidArgumentError('options', `options is ${shown(options)}; it must be an object.`);
}
