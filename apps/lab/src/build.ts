/** The build puts it in: see packages/tools/src/build-facts.ts. */
declare const WEBSPLATTER_BUILD: { readonly version: string; readonly commit: string | null };

/** Version of WebSplatter and commit of the working copy that the lab was built from. */
export const BUILD = WEBSPLATTER_BUILD;
