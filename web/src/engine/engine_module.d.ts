/** What `vite_engine.ts` serves: the module of web/engine/binding.cpp. */
declare module "virtual:gridlock-engine" {
  /** The text of a JSON, an array or a number; or the text of a JSON of an error. */
  export type Answer<Value> = { value: Value; error?: undefined } | { value?: undefined; error: string };

  export interface SessionBinding {
    description(): Answer<string>;
    status(): Answer<string>;
    notes(): Answer<string>;
    configuration(): Answer<string>;
    values(): Answer<string>;
    advance(steps: number, milliseconds: number): Answer<number>;
    lengthen(): Answer<boolean>;
    ids(): Answer<Float64Array>;
    column(name: string): Answer<Float64Array | Int32Array | Uint32Array | BigUint64Array>;
    positions(): Answer<Float32Array>;
    radii(): Answer<Float32Array>;
    drawnColumn(name: string): Answer<Float32Array>;
    series(fromRow: number): Answer<Float64Array>;
    results(): Answer<string>;
    protocolTables(): Answer<string>;
    stateHash(): Answer<string>;
    neighbourhood(id: number): Answer<string>;
    contactIds(): Answer<Float64Array>;
    contactForces(): Answer<Float64Array>;
    save(): Answer<Uint8Array>;
    restore(bytes: Uint8Array): Answer<boolean>;
    delete(): void;
  }

  export interface EngineModule {
    catalogue(): Answer<string>;
    open(toml: string, overrides: readonly string[]): Answer<SessionBinding>;
    read(toml: string, overrides: readonly string[]): Answer<string>;
    merge(toml: string, overrides: readonly string[]): Answer<string>;
    /** Both end the engine, for tests of what follows. */
    trap(): never;
    fillStack(depth: number): never;
  }

  type InstantiateWasm = import("./instantiate.ts").InstantiateWasm;
  export default function createEngine(options: { instantiateWasm: InstantiateWasm }): Promise<EngineModule>;
  /** Base64 of the gzip of the WebAssembly. */
  export const packedModule: string;
}

/** The module of web/engine/xyz_binding.cpp. */
declare module "virtual:gridlock-xyz" {
  /** Or the text of a JSON of an error. */
  export type Answer<Value> = { value: Value; error?: undefined } | { value?: undefined; error: string };

  export interface ReadFrame {
    /** NaN where the file does not say; of the time too. */
    readonly step: number;
    readonly time: number;
    readonly box?: {
      readonly width: number;
      readonly height: number;
      readonly periodic: boolean | readonly [boolean, boolean];
      /** xy of the Lattice, which may be longer than the width. */
      readonly shift: number;
    };
    readonly ids: Float64Array;
    readonly columns: readonly { readonly name: string; readonly values: Float64Array }[];
    readonly notes: readonly string[];
  }

  export interface XyzModule {
    readFrame(bytes: Uint8Array, name: string, firstLine: number): Answer<ReadFrame>;
    /** Without agents. */
    readHead(bytes: Uint8Array, name: string, firstLine: number): Answer<ReadFrame>;
  }

  type InstantiateWasm = import("../engine/instantiate.ts").InstantiateWasm;
  export default function createXyzReader(options: { instantiateWasm: InstantiateWasm }): Promise<XyzModule>;
  /** Base64 of the gzip of the WebAssembly. */
  export const packedModule: string;
}
