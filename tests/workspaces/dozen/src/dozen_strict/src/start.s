	.text
	.globl one
	.type one, @function
one:
	movl $1, %eax
	ret
	.size one, .-one
	.section .note.GNU-stack,"",@progbits
