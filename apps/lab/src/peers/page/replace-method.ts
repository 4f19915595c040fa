// biome-ignore lint/suspicious/noExplicitAny: any method at all, whose caller knows its arguments
type Method = (...args: any[]) => any;

/** Replaces a method by the result of `wrap`. */
export function replaceMethod<Prototype extends object, Name extends keyof Prototype>(
  prototype: Prototype,
  name: Name,
  wrap: (method: Extract<Prototype[Name], Method>) => Prototype[Name],
): void {
  prototype[name] = wrap(prototype[name] as Extract<Prototype[Name], Method>);
}
