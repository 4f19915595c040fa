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

/** Calls `note` after each call of a method: with its object, its arguments, and what it returned. */
export function noteCalls<Prototype extends object, Name extends keyof Prototype>(
  prototype: Prototype,
  name: Name,
  note: (
    object: Prototype,
    args: Parameters<Extract<Prototype[Name], Method>>,
    result: ReturnType<Extract<Prototype[Name], Method>>,
  ) => void,
): void {
  replaceMethod(
    prototype,
    name,
    (method) =>
      function (this: Prototype, ...args: Parameters<typeof method>) {
        const result = method.apply(this, args);
        note(this, args, result);
        return result;
      } as Prototype[Name],
  );
}
