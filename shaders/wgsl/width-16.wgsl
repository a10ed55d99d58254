// Registers of a perceptron with up to 16 units in each hidden layer. Narrower ones are padded with units whose
// weights and biases are zero: every activation gives 0 there, so they add nothing.
// A constant width lets compilers unroll the loops over units and keep these arrays out of memory.

// Units by fours.
const irradia_blocks: u32 = 4u;
// Vec4s of a row of blocks, and of a matrix, from one hidden layer to the next.
const irradia_row_stride: u32 = 16u;
const irradia_matrix: u32 = 64u;

// Before and after an activation: of the layer at hand, and of the one that is being summed.
var<private> irradia_units: array<vec4f, 4>;
var<private> irradia_sums: array<vec4f, 4>;
